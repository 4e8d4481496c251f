// SPDX-License-Identifier: Apache-2.0
// What the rays of all timed scans say about the presence of each object.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "mapping/clouds/cloud.hpp"
#include "mapping/presence/ray_pass.hpp"
#include "perception/segments/scene.hpp"
#include "perception/visibility/presence.hpp"
#include "perception/visibility/ray_bundle.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

struct ObjectVotes {
  std::vector<Eigen::Vector3d> places;       ///< that rays are compared with [m, map]; none of ground
  std::vector<perception::ScanVotes> votes;  ///< of the times at which a scan says something, ascending
};

/// The places on an object that rays are compared with [m, map]; none of ground.
std::vector<Eigen::Vector3d> placesOn(const perception::Scene& scene, const rules::SemanticObject& object);

/// Whether rays of the cloud may pass a place or end there.
bool mayPass(const Cloud& cloud, const std::vector<Eigen::Vector3d>& places);
/// The same with the box around the places, which is fast for clouds that are far away.
bool mayPass(const Cloud& cloud, const std::vector<Eigen::Vector3d>& places, const Eigen::AlignedBox3d& box);
Eigen::AlignedBox3d boxAround(const std::vector<Eigen::Vector3d>& places);

/// Collects the votes for each object. Rays are compared with up to 256 cluxels of an object, at least 0.3 m above the
/// ground where it has such. Ground gets no votes, nor does anything when fewer than two clouds have a time and a pose.
/// Cost: linear in the rays of the timed scans that may pass some object, and in the cluxels compared times the scans
/// within range.
class PresenceVoting : public RayObserver {
 public:
  /// `objects` are not kept.
  PresenceVoting(const perception::Scene& scene, std::span<const rules::SemanticObject> objects,
                 const std::vector<Cloud>& clouds, unsigned threads);
  bool wants(const Cloud& cloud) const override;
  std::unique_ptr<ScanView> view(const Cloud& cloud) const override;
  void take(const ScanView& seen) override;
  /// The votes; the collection is empty afterwards.
  std::vector<ObjectVotes> finish();

 private:
  struct Sphere {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double radius_m = 0;
  };
  static Sphere sphereAround(const std::vector<Eigen::Vector3d>& places);
  class View;

  bool is_told_ = false;  ///< two clouds or more have a time and a pose
  std::vector<ObjectVotes> votes_;
  std::vector<Sphere> spheres_;
  std::vector<Eigen::AlignedBox3d> boxes_;  ///< around the places of each object
};

/// The votes for each object, from all clouds. `load` gives a cloud's scan.
std::vector<ObjectVotes> presenceVotes(const perception::Scene& scene, std::span<const rules::SemanticObject> objects,
                                       const std::vector<Cloud>& clouds,
                                       const std::function<scan::Scan(const Cloud&)>& load, unsigned threads);

/// When each object was there.
std::vector<std::optional<perception::Presence>> presenceOfObjects(const std::vector<ObjectVotes>& votes);

}  // namespace cluxel::mapping
