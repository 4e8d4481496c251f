// SPDX-License-Identifier: Apache-2.0
// The ellipsoid in a box, seen from far away, is an ellipse.
#include "perception/visibility/place.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace cluxel::perception {

namespace {

constexpr double kInner = 0.6;              ///< share of the box that the ellipsoid fills along each axis
constexpr double kErrorOfPoints_m = 0.015;  ///< half axis below which an ellipse may be a scatter of points

double smallerEigenvalue(const Eigen::Matrix2d& symmetric) {
  const double mean = 0.5 * symmetric.trace(), half_difference = 0.5 * (symmetric(0, 0) - symmetric(1, 1));
  return mean - std::hypot(half_difference, symmetric(0, 1));
}

}  // namespace

Silhouette::Silhouette(const Place& place, const Eigen::Vector3d& origin_map, double elevation_error_rad)
    : centre_(place.at - origin_map + 0.5 * (place.low + place.high).cast<double>()) {
  const Eigen::Vector3d way = centre_.normalized();
  const bool is_upright = way.head<2>().norm() < 1e-6;
  const Eigen::Vector3d level = is_upright ? way.unitOrthogonal() : Eigen::Vector3d::UnitZ().cross(way).normalized();
  across_ << level.transpose(), way.cross(level).transpose();
  const Eigen::Vector3d half = 0.5 * (place.high - place.low).cast<double>();
  const Eigen::Matrix2d squares = across_ * half.cwiseAbs2().asDiagonal() * across_.transpose();
  error_up_m_ = elevation_error_rad * centre_.norm();
  half_width_m_ = std::sqrt(std::max(smallerEigenvalue(squares), 0.0));
  if (kInner * half_width_m_ >= kErrorOfPoints_m) inverse_ = (kInner * kInner * squares).inverse();
}

bool Silhouette::isMetBy(const Eigen::Vector3d& end) const {
  if (kInner * half_width_m_ < kErrorOfPoints_m) return false;
  const Eigen::Vector3d nearest = end * (centre_.dot(end) / end.squaredNorm());
  const Eigen::Vector2d aside = across_ * (nearest - centre_);
  const auto is_inside = [&](const Eigen::Vector2d& at) { return at.dot(inverse_ * at) <= 1; };
  const Eigen::Vector2d up(0, error_up_m_);
  return is_inside(aside + up) && is_inside(aside - up);
}

}  // namespace cluxel::perception
