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

/// Thinned points of one scan in its sensor frame, and planes through the 20 nearest ones of some of them, or of all.
/// Reading is thread-safe.
class SurfaceCloud {
 public:
  /// `with_plane`: numbers of points, ascending.
  SurfaceCloud(std::vector<Eigen::Vector3f> p_sensor, std::vector<std::size_t> with_plane)
      : grid_(p_sensor, kMaxReach_m),
        points_(std::move(p_sensor)),
        with_plane_(std::move(with_plane)),
        planes_(points_.size(), SurfacePlane{.flatness = kNoPlane}) {
    const std::vector<SurfacePlane> planes = pcl().planesAt(points_, with_plane_);
    for (std::size_t k = 0; k < planes.size(); ++k) planes_[with_plane_[k]] = planes[k];
  }

  std::size_t size() const { return points_.size(); }
  const std::vector<std::size_t>& withPlane() const { return with_plane_; }
  bool hasPlane(std::size_t i) const { return planes_[i].flatness != kNoPlane; }
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
  static constexpr double kNoPlane = -1;

  NearestGrid grid_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<std::size_t> with_plane_;
  std::vector<SurfacePlane> planes_;
};

}  // namespace cluxel::scan
