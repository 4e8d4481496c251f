// SPDX-License-Identifier: Apache-2.0
// Objects vote in parallel about one scan after the other.
#include "mapping/presence/presence_votes.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

using perception::RayVerdict;

constexpr float kClearOfGround_m = 0.3F;
/// More than the distances at which a ray concerns a place (RayParams).
constexpr double kAroundRays_m = 1;

}  // namespace

/// Rays that graze the ground beside a low place end near it: such places are left out where there are others.
std::vector<Eigen::Vector3d> placesOn(const perception::Scene& scene, const rules::SemanticObject& object) {
  const perception::SceneCluxels& cluxels = scene.cluxels;
  if (object.class_iri == rdf::vocabulary::clx("Ground")) return {};
  std::vector<std::uint32_t> members = cluxelsOf(object);
  std::vector<std::uint32_t> clear = members;
  std::erase_if(clear, [&](std::uint32_t c) { return cluxels.height_above_ground[c] < kClearOfGround_m; });
  if (!clear.empty()) members = std::move(clear);
  std::vector<Eigen::Vector3d> places;
  const std::size_t step = (members.size() + perception::kMaxPlaces - 1) / perception::kMaxPlaces;
  for (std::size_t i = 0; i < members.size(); i += step) places.push_back(cluxels.center[members[i]]);
  return places;
}

bool mayPass(const Cloud& cloud, const std::vector<Eigen::Vector3d>& places) {
  const Eigen::Vector3d around = Eigen::Vector3d::Constant(kAroundRays_m);
  const Eigen::AlignedBox3d reached(cloud.rays.min() - around, cloud.rays.max() + around);
  return std::any_of(places.begin(), places.end(),
                     [&](const Eigen::Vector3d& place) { return reached.contains(place); });
}

PresenceVoting::Sphere PresenceVoting::sphereAround(const std::vector<Eigen::Vector3d>& places) {
  Sphere sphere;
  for (const Eigen::Vector3d& place : places) sphere.centre += place / static_cast<double>(places.size());
  for (const Eigen::Vector3d& place : places)
    sphere.radius_m = std::max(sphere.radius_m, (place - sphere.centre).norm());
  return sphere;
}

PresenceVoting::PresenceVoting(const perception::Scene& scene, std::span<const rules::SemanticObject> objects,
                               const std::vector<Cloud>& clouds, unsigned threads)
    : is_told_(timedClouds(clouds).size() >= 2), threads_(threads), votes_(objects.size()), spheres_(objects.size()) {
  if (!is_told_) return;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    votes_[i].places = placesOn(scene, objects[i]);
    spheres_[i] = sphereAround(votes_[i].places);
  }
}

bool PresenceVoting::wants(const Cloud& cloud) {
  closeScan();
  if (!is_told_ || !cloud.time_s || !cloud.has_pose) return false;
  is_passed_.clear();
  for (const ObjectVotes& object : votes_)
    is_passed_.push_back(!object.places.empty() && mayPass(cloud, object.places) ? 1 : 0);
  if (std::count(is_passed_.begin(), is_passed_.end(), 1) == 0) return false;
  of_scan_.assign(votes_.size(), {*cloud.time_s, {}, {}});
  return true;
}

void PresenceVoting::look(const perception::RayBundle& bundle) {
  constexpr perception::RayParams kParams;
  parallelFor(votes_.size(), threads_, [&](std::size_t i) {
    const std::vector<Eigen::Vector3d>& places = votes_[i].places;
    const double range_m = bundle.maxRange_m() + spheres_[i].radius_m + kParams.hit_m;
    if (is_passed_[i] == 0 || (spheres_[i].centre - bundle.origin()).norm() > range_m) return;
    for (std::size_t place = 0; place < places.size(); ++place) {
      const RayVerdict verdict = bundle.verdictAt(places[place], kParams).verdict;
      if (verdict == RayVerdict::Hit) of_scan_[i].hits.set(place);
      if (verdict == RayVerdict::SeenThrough) of_scan_[i].seen_through.set(place);
    }
  });
}

void PresenceVoting::closeScan() {
  for (std::size_t i = 0; i < of_scan_.size(); ++i)
    if ((of_scan_[i].hits | of_scan_[i].seen_through).any()) perception::addVotes(votes_[i].votes, of_scan_[i]);
  of_scan_.clear();
}

std::vector<ObjectVotes> PresenceVoting::finish() {
  closeScan();
  return std::move(votes_);
}

std::vector<ObjectVotes> presenceVotes(const perception::Scene& scene, std::span<const rules::SemanticObject> objects,
                                       const std::vector<Cloud>& clouds,
                                       const std::function<scan::Scan(const Cloud&)>& load, unsigned threads) {
  PresenceVoting voting(scene, objects, clouds, threads);
  passRays(clouds, std::array<RayObserver*, 1>{&voting}, load);
  return voting.finish();
}

std::vector<std::optional<perception::Presence>> presenceOfObjects(const std::vector<ObjectVotes>& votes) {
  std::vector<std::optional<perception::Presence>> presence;
  presence.reserve(votes.size());
  for (const ObjectVotes& object : votes)
    presence.push_back(presenceOf(object.votes, perception::visibilityOf(object.votes), {}));
  return presence;
}

}  // namespace cluxel::mapping
