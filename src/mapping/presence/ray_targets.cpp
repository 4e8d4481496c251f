// SPDX-License-Identifier: Apache-2.0
// Large objects give places at even steps.
#include "mapping/presence/ray_targets.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "mapping/facts/object_geometry.hpp"
#include "perception/visibility/presence.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

constexpr float kClearOfGround_m = 0.3F;
constexpr float kInside_m = 0.30F;
constexpr double kEdgeCell_m = 0.5;
constexpr std::size_t kMaxInnerPlaces = 512;

}  // namespace

perception::Place rayPlaceOf(const perception::SceneCluxels& cluxels, std::uint32_t cluxel,
                             const std::function<bool(std::uint32_t)>& is_of_same_thing) {
  Eigen::AlignedBox3d box;
  const auto extend = [&](std::uint32_t c) {
    box.extend(cluxels.low_corner[c]);
    box.extend(Eigen::Vector3d(cluxels.low_corner[c] + cluxels.extent[c].cast<double>()));
  };
  extend(cluxel);
  for (const std::uint32_t other : cluxels.neighbours(cluxel))
    if (is_of_same_thing(other)) extend(other);
  const Eigen::Vector3d& at = cluxels.center[cluxel];
  return {at, (box.min() - at).cast<float>(), (box.max() - at).cast<float>()};
}

/// Rays that graze the ground beside a low place end near it: such places are left out where there are others.
std::vector<perception::Place> placesOn(const perception::Scene& scene, const rules::SemanticObject& object) {
  const perception::SceneCluxels& cluxels = scene.cluxels;
  if (object.class_iri == rdf::vocabulary::clx("Ground")) return {};
  const std::vector<std::uint32_t> all = cluxelsOf(object);
  std::vector<std::uint32_t> members = all, clear = all;
  std::erase_if(clear, [&](std::uint32_t c) { return cluxels.height_above_ground[c] < kClearOfGround_m; });
  if (!clear.empty()) members = std::move(clear);
  const auto is_member = [&all](std::uint32_t c) { return std::binary_search(all.begin(), all.end(), c); };
  std::vector<perception::Place> places;
  const std::size_t step = (members.size() + perception::kMaxPlaces - 1) / perception::kMaxPlaces;
  for (std::size_t i = 0; i < members.size(); i += step) places.push_back(rayPlaceOf(cluxels, members[i], is_member));
  return places;
}

std::vector<Eigen::Vector3d> placesWithin(const perception::Scene& scene, const rules::SemanticObject& object) {
  const perception::SceneCluxels& cluxels = scene.cluxels;
  const auto cell_of = [&](std::uint32_t c) {
    const Eigen::Vector3d center = cluxels.center[c] - cluxels.grid.corner();
    return std::pair(static_cast<std::int64_t>(std::floor(center.x() / kEdgeCell_m)),
                     static_cast<std::int64_t>(std::floor(center.y() / kEdgeCell_m)));
  };
  const std::vector<std::uint32_t> members = cluxelsOf(object);
  std::map<std::pair<std::int64_t, std::int64_t>, float> edge;  // height above ground of the highest cluxel
  for (const std::uint32_t c : members) {
    const auto [x, y] = cell_of(c);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy) {
        float& high = edge.emplace(std::pair(x + dx, y + dy), 0.0F).first->second;
        high = std::max(high, cluxels.height_above_ground[c]);
      }
  }
  std::vector<std::uint32_t> inner;
  for (const std::uint32_t c : members) {
    const float height = cluxels.height_above_ground[c];
    if (height >= kInside_m && height <= edge.at(cell_of(c)) - kInside_m) inner.push_back(c);
  }
  std::vector<Eigen::Vector3d> places;
  const std::size_t step = (inner.size() + kMaxInnerPlaces - 1) / kMaxInnerPlaces;
  for (std::size_t i = 0; i < inner.size(); i += step) places.push_back(cluxels.center[inner[i]]);
  return places;
}

std::vector<RayTarget> rayTargets(const perception::Scene& scene, std::span<const rules::SemanticObject> objects,
                                  const rules::RuleSet& rules) {
  std::vector<RayTarget> targets;
  targets.reserve(objects.size());
  for (const rules::SemanticObject& object : objects) {
    RayTarget& target = targets.emplace_back(RayTarget{object.id, placesOn(scene, object), {}});
    if (rules.catalogue.isA(object.class_iri, rdf::vocabulary::clx("Barrier")))
      target.inner_places = placesWithin(scene, object);
  }
  return targets;
}

void LaterTargets::add(std::vector<RayTarget> targets) {
  for (RayTarget& target : targets) {
    const ContentHash object = target.object;
    targets_.insert_or_assign(object, std::move(target));
  }
}

void LaterTargets::remove(const std::set<ContentHash>& objects) {
  for (const ContentHash& object : objects) targets_.erase(object);
  removed_.insert(objects.begin(), objects.end());
}

std::vector<RayTarget> LaterTargets::take() {
  std::vector<RayTarget> targets;
  targets.reserve(targets_.size());
  for (auto& [object, target] : targets_) targets.push_back(std::move(target));
  targets_.clear();
  return targets;
}

}  // namespace cluxel::mapping
