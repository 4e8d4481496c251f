// SPDX-License-Identifier: Apache-2.0
// Shape of a set of points from the eigenvalues and eigenvectors of its covariance.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "perception/moments.hpp"

namespace cluxel {

/// Zero everywhere for a set without extent; `normal` is zero for a set that lies on a line, which has none.
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
/// Below this share of l1, l2 counts as none.
inline constexpr double kOnALine = 1e-4;

/// xx xy xz yy yz zz [m2]
using Covariance = std::array<double, 6>;

/// Of stored moments: the covariance over the points.
Covariance covarianceOf(const Moments& moments);
/// Of a sum that is not finished yet.
Covariance covarianceOf(const MomentSum& sum);

/// Shapes of up to four sets, found together: the shape of a set does not depend on its companions. In float, which is
/// far finer than points are, and without functions of a library: the same bits on every machine.
std::array<EigenShape, 4> shapesOf(std::span<const Covariance> covariances);
inline EigenShape shapeOf(const Covariance& covariance) {
  return shapesOf({&covariance, 1})[0];
}

/// Collects sets until four can be solved together; `keep(number, shape)` receives them in the order they came.
class FourShapes {
 public:
  template <typename Keep>
  void add(std::size_t number, const Covariance& covariance, const Keep& keep) {
    covariance_[count_] = covariance;
    number_[count_++] = number;
    if (count_ == covariance_.size()) finish(keep);
  }
  /// Solves what is left.
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

}  // namespace cluxel
