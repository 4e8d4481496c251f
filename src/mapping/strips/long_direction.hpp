// SPDX-License-Identifier: Apache-2.0
// The direction along which an area is divided, so that its parts have short borders.
#pragma once

#include <Eigen/Eigenvalues>

namespace cluxel::mapping {

/// The direction in which places (one a column) spread most, by principal components. x when they spread alike.
inline Eigen::Vector2d longDirection(const Eigen::Matrix2Xd& places) {
  if (places.cols() < 2) return Eigen::Vector2d::UnitX();
  const Eigen::Matrix2Xd centred = places.colwise() - places.rowwise().mean();
  const Eigen::Matrix2d spread = centred * centred.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread);
  const Eigen::Vector2d values = solver.eigenvalues();
  if (!(values[1] > 1.01 * values[0])) return Eigen::Vector2d::UnitX();
  const Eigen::Vector2d along = solver.eigenvectors().col(1);
  return along.x() < 0 || (along.x() == 0 && along.y() < 0) ? Eigen::Vector2d(-along) : along;
}

}  // namespace cluxel::mapping
