// SPDX-License-Identifier: Apache-2.0
// The only use of PCL's search trees and its generalised ICP.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "scan/registration/nearest_grid.hpp"

namespace cluxel::scan {

/// Thinned points of one scan in its sensor frame, each with the plane through its neighbours. Reading is thread-safe.
class SurfaceCloud {
 public:
  /// The normal of a point is that of its 20 nearest ones.
  explicit SurfaceCloud(const std::vector<Eigen::Vector3f>& p_sensor);
  ~SurfaceCloud();
  SurfaceCloud(SurfaceCloud&&) noexcept;
  SurfaceCloud& operator=(SurfaceCloud&&) noexcept;

  std::size_t size() const;
  Eigen::Vector3d point(std::size_t i) const;
  Eigen::Vector3d normal(std::size_t i) const;
  /// In [0, 1]: 1 for neighbours that fill a disc, 0 for a line or a ball.
  double flatness(std::size_t i) const;
  /// The point nearest to `p`, when there is one within `reach_m`, which is at most kMaxReach_m.
  std::optional<std::size_t> nearest(const Eigen::Vector3d& p, double reach_m) const {
    return grid_.nearest(p, reach_m);
  }
  static constexpr double kMaxReach_m = 0.5;

  struct Parts;
  const Parts& parts() const { return *parts_; }

 private:
  NearestGrid grid_;
  std::unique_ptr<Parts> parts_;
};

/// Where generalised ICP (Segal, Haehnel, Thrun 2009, as PCL has it) moves `source`, from a first guess; absent when it
/// fails. It may end on its last iteration, a hair from rest: whether to believe it is for evidenceOf to say. Points
/// further than `reach_m` from the other cloud do not count.
std::optional<Eigen::Isometry3d> alignedByGicp(const SurfaceCloud& target, const SurfaceCloud& source,
                                               const Eigen::Isometry3d& T_target_source, double reach_m);

}  // namespace cluxel::scan
