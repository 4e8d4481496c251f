// SPDX-License-Identifier: Apache-2.0
// A scan as registration sees it: points with the planes through their neighbours.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <vector>

#include "scan/pcl/pcl_functions.hpp"
#include "scan/registration/nearest_grid.hpp"

namespace cluxel::scan {

/// Thinned points of one scan in its sensor frame, each with the plane through its 20 nearest ones. Reading is
/// thread-safe.
class SurfaceCloud {
 public:
  explicit SurfaceCloud(std::vector<Eigen::Vector3f> p_sensor)
      : grid_(p_sensor, kMaxReach_m), points_(std::move(p_sensor)), planes_(pcl().planesOf(points_)) {}

  std::size_t size() const { return points_.size(); }
  const std::vector<Eigen::Vector3f>& points() const { return points_; }
  Eigen::Vector3d point(std::size_t i) const { return points_[i].cast<double>(); }
  const Eigen::Vector3d& normal(std::size_t i) const { return planes_[i].normal; }
  double flatness(std::size_t i) const { return planes_[i].flatness; }
  /// The point nearest to `p`, when there is one within `reach_m`, which is at most kMaxReach_m.
  std::optional<std::size_t> nearest(const Eigen::Vector3d& p, double reach_m) const {
    return grid_.nearest(p, reach_m);
  }
  static constexpr double kMaxReach_m = 0.5;

 private:
  NearestGrid grid_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<SurfacePlane> planes_;
};

}  // namespace cluxel::scan
