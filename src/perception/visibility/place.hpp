// SPDX-License-Identifier: Apache-2.0
// A place on a thing with the extent of the thing around it, and which rays would end there.
#pragma once

#include <Eigen/Core>

namespace cluxel::perception {

struct Place {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< [m, map]
  /// The corners of the box around the thing's points near the place, relative to it [m].
  Eigen::Vector3f low = Eigen::Vector3f::Zero(), high = Eigen::Vector3f::Zero();
};
static_assert(sizeof(Place) == 48, "places are hashed as bytes");

/// What a sensor sees of a thing around a place. A ray meets it when it passes well within it: through the ellipsoid
/// that fills 0.6 of the width, depth and height of the box, even if its elevation were wrong. Nearer to the edge of
/// the box there may be nothing: points scatter around what was measured, and a round pole does not fill a box.
class Silhouette {
 public:
  /// `origin_map`: where the rays start [m]. `elevation_error_rad`: of rays, either way.
  Silhouette(const Place& place, const Eigen::Vector3d& origin_map, double elevation_error_rad);

  /// Half the width of the box in the direction across the rays in which it is thinnest [m].
  double halfWidth_m() const { return half_width_m_; }
  /// Whether a ray would end there. `end`: of the ray, relative to its start [m]. No ray would for certain where the
  /// ellipsoid is thinner than the errors of points: of a roof that the sensor sees edge-on.
  bool isMetBy(const Eigen::Vector3d& end) const;

 private:
  Eigen::Vector3d centre_;                             ///< of the box, relative to the start of the rays [m]
  Eigen::Matrix<double, 2, 3> across_;                 ///< two directions across the rays: level, and upwards
  Eigen::Matrix2d inverse_ = Eigen::Matrix2d::Zero();  ///< of the squared half axes of the ellipsoid across the rays
  double half_width_m_ = 0, error_up_m_ = 0;
};

}  // namespace cluxel::perception
