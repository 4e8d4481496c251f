// SPDX-License-Identifier: Apache-2.0
// Scans are loaded one after the other; objects vote in parallel.
#include "mapping/facts/presence_votes.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

using perception::RayVerdict;

constexpr float kClearOfGround_m = 0.3F;
/// More than the distances at which a ray concerns a place (RayParams).
constexpr double kAroundRays_m = 1;

struct Sphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius_m = 0;
};

Sphere sphereAround(const std::vector<Eigen::Vector3d>& places) {
  Sphere sphere;
  for (const Eigen::Vector3d& place : places) sphere.centre += place / static_cast<double>(places.size());
  for (const Eigen::Vector3d& place : places)
    sphere.radius_m = std::max(sphere.radius_m, (place - sphere.centre).norm());
  return sphere;
}

void vote(const perception::RayBundle& bundle, const std::vector<Eigen::Vector3d>& places, const Sphere& sphere,
          perception::ScanVotes& votes) {
  constexpr perception::RayParams kParams;
  if ((sphere.centre - bundle.origin()).norm() > bundle.maxRange_m() + sphere.radius_m + kParams.hit_m) return;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const RayVerdict verdict = bundle.verdictAt(places[i], kParams).verdict;
    if (verdict == RayVerdict::Hit) votes.hits.set(i);
    if (verdict == RayVerdict::SeenThrough) votes.seen_through.set(i);
  }
}

}  // namespace

std::vector<const Cloud*> timedClouds(const std::vector<Cloud>& clouds) {
  std::vector<const Cloud*> timed;
  for (const Cloud& cloud : clouds)
    if (cloud.time_s && cloud.has_pose) timed.push_back(&cloud);
  std::sort(timed.begin(), timed.end(), [](const Cloud* a, const Cloud* b) {
    return std::pair(*a->time_s, a->id.hex()) < std::pair(*b->time_s, b->id.hex());
  });
  return timed;
}

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
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& place : places) box.extend(place);
  const Eigen::Vector3d around = Eigen::Vector3d::Constant(kAroundRays_m);
  return cloud.rays.intersects(Eigen::AlignedBox3d(box.min() - around, box.max() + around));
}

std::vector<ObjectVotes> presenceVotes(const perception::Scene& scene, std::span<const rules::SemanticObject> objects,
                                       const std::vector<Cloud>& clouds,
                                       const std::function<scan::Scan(const Cloud&)>& load, unsigned threads) {
  std::vector<ObjectVotes> result(objects.size());
  const std::vector<const Cloud*> timed = timedClouds(clouds);
  if (timed.size() < 2) return result;
  std::vector<Sphere> spheres(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    result[i].places = placesOn(scene, objects[i]);
    spheres[i] = sphereAround(result[i].places);
  }
  for (const Cloud* cloud : timed) {
    const auto isPassed = [&](const ObjectVotes& object) {
      return !object.places.empty() && mayPass(*cloud, object.places);
    };
    if (std::none_of(result.begin(), result.end(), isPassed)) continue;
    std::vector<perception::ScanVotes> of_scan(objects.size(), {*cloud->time_s, {}, {}});
    perception::forEachRayBundle(load(*cloud), [&](const perception::RayBundle& bundle) {
      parallelFor(objects.size(), threads, [&](std::size_t i) {
        if (!result[i].places.empty()) vote(bundle, result[i].places, spheres[i], of_scan[i]);
      });
    });
    for (std::size_t i = 0; i < objects.size(); ++i)
      if ((of_scan[i].hits | of_scan[i].seen_through).any()) perception::addVotes(result[i].votes, of_scan[i]);
  }
  return result;
}

std::vector<std::optional<perception::Presence>> presenceOfObjects(const std::vector<ObjectVotes>& votes) {
  std::vector<std::optional<perception::Presence>> presence;
  presence.reserve(votes.size());
  for (const ObjectVotes& object : votes)
    presence.push_back(presenceOf(object.votes, perception::visibilityOf(object.votes), {}));
  return presence;
}

}  // namespace cluxel::mapping
