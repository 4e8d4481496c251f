// SPDX-License-Identifier: Apache-2.0
// Stored counts are found by a hash of all that they follow from.
#include "mapping/presence/passed_rays.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

#include "base/content_hash.hpp"
#include "base/parallel.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/presence/presence_votes.hpp"

namespace cluxel::mapping {

namespace {

/// The version of the computation. A new number invalidates all stored counts.
constexpr std::uint32_t kCountsVersion = 1;
constexpr float kInside_m = 0.30F;
constexpr double kEdgeCell_m = 0.5;
constexpr std::size_t kMaxInnerPlaces = 512;

/// Rays within a decimetre of a place: gaps between bars are not much wider.
constexpr perception::RayParams kThroughParams{.near_m = 0.10, .behind_m = 0.50};

/// A row of the stored table.
struct CountsRow {
  ContentHash cause;
  std::uint64_t ended = 0, passed = 0;
};
static_assert(sizeof(CountsRow) == 32);

std::optional<CountsRow> storedCounts(const rdf::ReadTransaction& transaction, const ContentHash& object) {
  const auto bytes = transaction.block(tables::kPassedRays, tables::keyOf(object));
  if (!bytes || bytes->size() != sizeof(CountsRow)) return std::nullopt;
  CountsRow row;
  std::memcpy(&row, bytes->data(), sizeof row);
  return row;
}

/// The hash of what a cloud's rays say: its points are named by its id.
ContentHash raysHash(const Cloud& cloud) {
  const Eigen::Matrix4d pose = cloud.T_map_sensor.matrix();
  return ContentHasher().add(cloud.id).add(cloud.has_pose).addBytes(pose.data(), sizeof(double) * 16).finish();
}

}  // namespace

std::vector<Eigen::Vector3d> placesWithin(const perception::Scene& scene, const rules::SemanticObject& object) {
  const perception::SceneCluxels& cluxels = scene.cluxels;
  const auto cell_of = [&](std::uint32_t c) {
    return std::pair(static_cast<std::int64_t>(std::floor(cluxels.center[c].x() / kEdgeCell_m)),
                     static_cast<std::int64_t>(std::floor(cluxels.center[c].y() / kEdgeCell_m)));
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

PassedRaysUpdate::PassedRaysUpdate(const rdf::ReadTransaction& transaction, const perception::Scene& scene,
                                   std::span<const rules::SemanticObject> objects, const std::vector<Cloud>& clouds,
                                   const CountsRays& counts_rays, unsigned threads)
    : RayObserver(threads), object_count_(objects.size()) {
  std::vector<ContentHash> hashes;
  for (const Cloud& cloud : clouds) hashes.push_back(raysHash(cloud));
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!counts_rays(objects[i])) continue;
    Target target{i, objects[i].id, placesWithin(scene, objects[i]), {}, {}};
    if (target.places.empty()) continue;
    const Eigen::AlignedBox3d box = boxAround(target.places);
    std::vector<ContentHash> passing;  // in an order that does not follow that of the clouds
    for (std::size_t c = 0; c < clouds.size(); ++c)
      if (mayPass(clouds[c], target.places, box)) passing.push_back(hashes[c]);
    std::sort(passing.begin(), passing.end());
    ContentHasher hasher;
    hasher.add(kCountsVersion).addBytes(target.places.data(), target.places.size() * sizeof(Eigen::Vector3d));
    for (const ContentHash& hash : passing) hasher.add(hash);
    target.cause = hasher.finish();
    targets_.push_back(std::move(target));
  }
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const std::optional<CountsRow> known = storedCounts(transaction, targets_[i].id);
    if (known && known->cause == targets_[i].cause)
      targets_[i].counts = {known->ended, known->passed};
    else
      unknown_.push_back(i);
  }
}

/// The counts of the targets that rays of a scan may pass.
class PassedRaysUpdate::View : public ScanView {
 public:
  struct Counted {
    std::size_t target = 0;
    perception::RayCounts counts;
  };

  View(const std::vector<Target>& targets, std::vector<Counted> passed)
      : targets_(targets), passed_(std::move(passed)) {}

  void look(const perception::RayBundle& bundle, unsigned threads) override {
    parallelFor(passed_.size(), threads, [&](std::size_t i) {
      for (const Eigen::Vector3d& place : targets_[passed_[i].target].places)
        passed_[i].counts += bundle.countsAt(place, kThroughParams);
    });
  }

  const std::vector<Counted>& passed() const { return passed_; }

 private:
  const std::vector<Target>& targets_;
  std::vector<Counted> passed_;
};

bool PassedRaysUpdate::wants(const Cloud& cloud) const {
  return std::any_of(unknown_.begin(), unknown_.end(),
                     [&](std::size_t i) { return mayPass(cloud, targets_[i].places); });
}

std::unique_ptr<ScanView> PassedRaysUpdate::view(const Cloud& cloud) const {
  std::vector<View::Counted> passed;
  for (const std::size_t i : unknown_)
    if (mayPass(cloud, targets_[i].places)) passed.push_back({i, {}});
  return std::make_unique<View>(targets_, std::move(passed));
}

void PassedRaysUpdate::take(const ScanView& seen) {
  for (const View::Counted& counted : dynamic_cast<const View&>(seen).passed())
    targets_[counted.target].counts += counted.counts;
}

std::vector<std::optional<perception::RayCounts>> PassedRaysUpdate::finish(rdf::WriteTransaction& transaction,
                                                                           Covered covered) const {
  std::vector<std::optional<perception::RayCounts>> result(object_count_);
  std::vector<ContentHash> counted;
  for (const Target& target : targets_) {
    const CountsRow row{target.cause, target.counts.ended, target.counts.passed};
    putRow(transaction, tables::kPassedRays, target.id, {reinterpret_cast<const char*>(&row), sizeof row});
    counted.push_back(target.id);
    if (target.counts.ended + target.counts.passed > 0) result[target.object] = target.counts;
  }
  if (covered == Covered::All) eraseRowsBut(transaction, tables::kPassedRays, std::move(counted));
  return result;
}

}  // namespace cluxel::mapping
