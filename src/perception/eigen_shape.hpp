// SPDX-License-Identifier: Apache-2.0
// Shape of a set of points from the eigenvalues and eigenvectors of its covariance.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "perception/moments.hpp"

namespace cluxel {

/// Zero everywhere for a set without extent; `normal` is zero for a set that lies on a line, which has none.
struct EigenShape {
  std::array<double, 3> value{};                          ///< l1 >= l2 >= l3 >= 0 [m2]
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();         ///< of l1
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();       ///< of l3

  double linearity() const { return value[0] > 0 ? (value[0] - value[1]) / value[0] : 0; }
  double planarity() const { return value[0] > 0 ? (value[1] - value[2]) / value[0] : 0; }
  double scattering() const { return value[0] > 0 ? value[2] / value[0] : 0; }
  double length(std::size_t i) const { return std::sqrt(value[i]); }
};

/// Below this a set counts as one point [m2].
inline constexpr double kNoExtent_m2 = 1e-9;
/// Below this share of l1, l2 counts as none.
inline constexpr double kOnALine = 1e-4;

inline EigenShape shapeOf(double xx, double xy, double xz, double yy, double yz, double zz) {
  EigenShape shape;
  if (!(xx + yy + zz > kNoExtent_m2)) return shape;
  Eigen::Matrix3f covariance;   // float: twice as fast, and far finer than the points are
  covariance.col(0) = Eigen::Vector3d(xx, xy, xz).cast<float>();
  covariance.col(1) = Eigen::Vector3d(xy, yy, yz).cast<float>();
  covariance.col(2) = Eigen::Vector3d(xz, yz, zz).cast<float>();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  const auto& values = solver.eigenvalues();
  shape.value = {std::max(0.0F, values[2]), std::max(0.0F, values[1]), std::max(0.0F, values[0])};
  shape.axis = solver.eigenvectors().col(2).cast<double>();
  if (shape.value[1] > kOnALine * shape.value[0]) shape.normal = solver.eigenvectors().col(0).cast<double>();
  return shape;
}

/// Of stored moments: the covariance over the points.
inline EigenShape shapeOf(const Moments& moments) {
  const auto& s = moments.scatter;
  const double n = std::max(1.0F, moments.count);
  return shapeOf(s[0] / n, s[1] / n, s[2] / n, s[3] / n, s[4] / n, s[5] / n);
}

/// Of a sum that is not finished yet.
inline EigenShape shapeOf(const MomentSum& sum) {
  if (!(sum.n > 0)) return {};
  const double x = sum.x / sum.n, y = sum.y / sum.n, z = sum.z / sum.n;
  return shapeOf(sum.xx / sum.n - x * x, sum.xy / sum.n - x * y, sum.xz / sum.n - x * z, sum.yy / sum.n - y * y,
                 sum.yz / sum.n - y * z, sum.zz / sum.n - z * z);
}

}  // namespace cluxel
