// SPDX-License-Identifier: Apache-2.0
// What the rays of all timed scans say about the presence of each object.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mapping/clouds/cloud.hpp"
#include "mapping/presence/ray_pass.hpp"
#include "perception/visibility/presence.hpp"
#include "perception/visibility/scan_rays.hpp"

namespace cluxel::mapping {

/// Of the times at which a scan says something about an object, ascending.
using ObjectVotes = std::vector<perception::ScanVotes>;

/// Whether rays of the cloud may pass a place or end there.
bool mayPass(const Cloud& cloud, std::span<const Eigen::Vector3d> places);
/// The same with the box around the places, which is fast for clouds that are far away.
bool mayPass(const Cloud& cloud, std::span<const Eigen::Vector3d> places, const Eigen::AlignedBox3d& box);
bool mayPass(const Cloud& cloud, std::span<const perception::Place> places, const Eigen::AlignedBox3d& box);
Eigen::AlignedBox3d boxAround(std::span<const Eigen::Vector3d> places);
Eigen::AlignedBox3d boxAround(std::span<const perception::Place> places);

/// Collects the votes for each object. One without places gets none, nor does anything when fewer than two clouds have
/// a time and a pose. Cost: linear in the rays of the timed scans that may pass some object, and in the places times
/// the scans within range.
class PresenceVoting : public RayObserver {
 public:
  /// `places`, by object, must outlive it.
  PresenceVoting(std::vector<std::span<const perception::Place>> places, const std::vector<Cloud>& clouds,
                 unsigned threads);
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
  static Sphere sphereAround(std::span<const perception::Place> places);
  class View;

  bool is_told_ = false;  ///< two clouds or more have a time and a pose
  std::vector<std::span<const perception::Place>> places_;
  std::vector<ObjectVotes> votes_;
  std::vector<Sphere> spheres_;
  std::vector<Eigen::AlignedBox3d> boxes_;  ///< around the places of each object
};

/// When each object was there.
std::vector<std::optional<perception::Presence>> presenceFrom(const std::vector<ObjectVotes>& votes);

}  // namespace cluxel::mapping
