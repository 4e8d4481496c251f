// SPDX-License-Identifier: Apache-2.0
// Shape of a set of points from the eigenvalues and eigenvectors of its covariance.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "perception/moments.hpp"

namespace cluxel::perception {

/// All zero for a set without extent. `normal` is zero for a collinear set.
struct EigenShape {
  std::array<double, 3> value{};                     ///< l1 >= l2 >= l3 >= 0 [m2]
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();    ///< of l1
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< of l3

  double linearity() const { return value[0] > 0 ? (value[0] - value[1]) / value[0] : 0; }
  double planarity() const { return value[0] > 0 ? (value[1] - value[2]) / value[0] : 0; }
  double scattering() const { return value[0] > 0 ? value[2] / value[0] : 0; }
  double length(std::size_t i) const { return std::sqrt(value[i]); }
};

/// Below this a set counts as one point [m2].
inline constexpr double kNoExtent_m2 = 1e-9;
/// If l2 is below this share of l1, the set is collinear.
inline constexpr double kOnALine = 1e-4;

/// xx xy xz yy yz zz [m2]
using Covariance = std::array<double, 6>;

/// The covariance of stored moments.
Covariance covarianceOf(const Moments& moments);
/// The covariance of a sum.
Covariance covarianceOf(const MomentSum& sum);

/// Shapes of up to four sets at once; the shape of a set does not depend on the others. Computed in float, which is far
/// finer than the noise of points, and without library functions: the same bits on every machine.
std::array<EigenShape, 4> shapesOf(std::span<const Covariance> covariances);
inline EigenShape shapeOf(const Covariance& covariance) {
  return shapesOf({&covariance, 1})[0];
}

/// Collects sets and solves four at a time; `keep(number, shape)` receives the results in insertion order.
class FourShapes {
 public:
  template <typename Keep>
  void add(std::size_t number, const Covariance& covariance, const Keep& keep) {
    covariance_[count_] = covariance;
    number_[count_++] = number;
    if (count_ == covariance_.size()) finish(keep);
  }
  /// Solves the remaining sets.
  template <typename Keep>
  void finish(const Keep& keep) {
    const auto shapes = shapesOf({covariance_.data(), count_});
    for (std::size_t i = 0; i < count_; ++i) keep(number_[i], shapes[i]);
    count_ = 0;
  }

 private:
  std::array<Covariance, 4> covariance_{};
  std::array<std::size_t, 4> number_{};
  std::size_t count_ = 0;
};

}  // namespace cluxel::perception
