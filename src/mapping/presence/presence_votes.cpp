// SPDX-License-Identifier: Apache-2.0
// Scans are looked at in parallel; their votes are added in the order of the scans.
#include "mapping/presence/presence_votes.hpp"

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"

namespace cluxel::mapping {

namespace {

using perception::RayVerdict;

/// More than the distances at which a ray concerns a place (RayParams).
constexpr double kAroundRays_m = 1;

/// Where rays of the cloud end, and what they may concern around.
Eigen::AlignedBox3d reachedBy(const Cloud& cloud) {
  const Eigen::Vector3d around = Eigen::Vector3d::Constant(kAroundRays_m);
  return {cloud.rays.min() - around, cloud.rays.max() + around};
}

}  // namespace

bool mayPass(const Cloud& cloud, std::span<const Eigen::Vector3d> places) {
  const Eigen::AlignedBox3d reached = reachedBy(cloud);
  return std::any_of(places.begin(), places.end(),
                     [&](const Eigen::Vector3d& place) { return reached.contains(place); });
}

bool mayPass(const Cloud& cloud, std::span<const Eigen::Vector3d> places, const Eigen::AlignedBox3d& box) {
  return reachedBy(cloud).intersects(box) && mayPass(cloud, places);
}

bool mayPass(const Cloud& cloud, std::span<const perception::Place> places, const Eigen::AlignedBox3d& box) {
  const Eigen::AlignedBox3d reached = reachedBy(cloud);
  return reached.intersects(box) && std::any_of(places.begin(), places.end(), [&](const perception::Place& place) {
           return reached.contains(place.at);
         });
}

Eigen::AlignedBox3d boxAround(std::span<const perception::Place> places) {
  Eigen::AlignedBox3d box;
  for (const perception::Place& place : places) box.extend(place.at);
  return box;
}

Eigen::AlignedBox3d boxAround(std::span<const Eigen::Vector3d> places) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& place : places) box.extend(place);
  return box;
}

PresenceVoting::Sphere PresenceVoting::sphereAround(std::span<const perception::Place> places) {
  Sphere sphere;
  for (const perception::Place& place : places) sphere.centre += place.at / static_cast<double>(places.size());
  for (const perception::Place& place : places)
    sphere.radius_m = std::max(sphere.radius_m, (place.at - sphere.centre).norm());
  return sphere;
}

PresenceVoting::PresenceVoting(std::vector<std::span<const perception::Place>> places, const std::vector<Cloud>& clouds,
                               unsigned threads)
    : RayObserver(threads),
      is_told_(timedClouds(clouds).size() >= 2),
      places_(std::move(places)),
      votes_(places_.size()),
      spheres_(places_.size()),
      boxes_(places_.size()) {
  if (!is_told_) places_.assign(places_.size(), {});
  for (std::size_t i = 0; i < places_.size(); ++i) {
    spheres_[i] = sphereAround(places_[i]);
    boxes_[i] = boxAround(places_[i]);
  }
}

/// The votes of one scan for the objects that its rays may pass.
class PresenceVoting::View : public ScanView {
 public:
  View(const PresenceVoting& voting, double time_s, std::vector<std::size_t> passed)
      : voting_(voting), passed_(std::move(passed)), votes_(passed_.size(), {time_s, {}, {}}) {}

  void look(const perception::ScanRays& rays, unsigned threads) override {
    constexpr perception::RayParams kParams;
    parallelFor(passed_.size(), threads, [&](std::size_t i) {
      const std::span<const perception::Place> places = voting_.places_[passed_[i]];
      const Sphere& sphere = voting_.spheres_[passed_[i]];
      if (!rays.mayConcern(sphere.centre, sphere.radius_m, kParams)) return;
      for (std::size_t place = 0; place < places.size(); ++place) {
        const perception::PlaceVerdict found = rays.verdictAt(places[place], kParams);
        if (found.verdict == RayVerdict::Hit) votes_[i].hits.set(place);
        if (found.verdict == RayVerdict::SeenThrough && !found.is_aside) votes_[i].seen_through.set(place);
      }
    });
  }

  const std::vector<std::size_t>& passed() const { return passed_; }          ///< numbers of objects
  const std::vector<perception::ScanVotes>& votes() const { return votes_; }  ///< for each of them

 private:
  const PresenceVoting& voting_;
  std::vector<std::size_t> passed_;
  std::vector<perception::ScanVotes> votes_;
};

bool PresenceVoting::wants(const Cloud& cloud) const {
  if (!is_told_ || !cloud.time_s || !cloud.has_pose) return false;
  for (std::size_t i = 0; i < votes_.size(); ++i)
    if (mayPass(cloud, places_[i], boxes_[i])) return true;
  return false;
}

std::unique_ptr<ScanView> PresenceVoting::view(const Cloud& cloud) const {
  std::vector<std::size_t> passed;
  for (std::size_t i = 0; i < votes_.size(); ++i)
    if (mayPass(cloud, places_[i], boxes_[i])) passed.push_back(i);
  return std::make_unique<View>(*this, *cloud.time_s, std::move(passed));
}

void PresenceVoting::take(const ScanView& seen) {
  const auto& view = dynamic_cast<const View&>(seen);
  for (std::size_t i = 0; i < view.passed().size(); ++i)
    if (const perception::ScanVotes& votes = view.votes()[i]; (votes.hits | votes.seen_through).any())
      perception::addVotes(votes_[view.passed()[i]], votes);
}

std::vector<ObjectVotes> PresenceVoting::finish() {
  return std::move(votes_);
}

std::vector<std::optional<perception::Presence>> presenceFrom(const std::vector<ObjectVotes>& votes) {
  std::vector<std::optional<perception::Presence>> presence;
  presence.reserve(votes.size());
  for (const ObjectVotes& object : votes) presence.push_back(presenceOf(object, perception::visibilityOf(object), {}));
  return presence;
}

}  // namespace cluxel::mapping
