// SPDX-License-Identifier: Apache-2.0
// Optimises all poses together: the smallest change of the given poses that satisfies the constraints of pairs.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "scan/registration/pair_evidence.hpp"

namespace cluxel::scan {

/// What is said about the pose of scan `second` in the frame of scan `first`: to be off by xi in T_first_second·exp(xi)
/// costs xi'·information·xi [m²].
struct PoseConstraint {
  std::size_t first = 0, second = 0;
  Eigen::Isometry3d T_first_second = Eigen::Isometry3d::Identity();
  Matrix6d information = Matrix6d::Zero();
};

struct PoseGraphParams {
  double trust_m = 1.0;  ///< standard deviation of a given position: negligible weight beside a pair
  double trust_rad = 0.1;
  double surface_m = 0.001;  ///< standard deviation of a constraint
};

/// Gauss-Newton from `start` on the sum of all costs, ten steps at most. A scan in no constraint keeps the bits of its
/// start. Cost: a sparse factorisation a step, about linear in the number of constraints for drives.
std::vector<Eigen::Isometry3d> solvePoseGraph(const std::vector<Eigen::Isometry3d>& given,
                                              const std::vector<Eigen::Isometry3d>& start,
                                              const std::vector<PoseConstraint>& constraints,
                                              const PoseGraphParams& params);

/// How a small motion makes a pose: T·exp(xi) is `T * motion(xi)`; and back.
Eigen::Isometry3d motion(const Vector6d& xi);
Vector6d smallMotion(const Eigen::Isometry3d& T);

}  // namespace cluxel::scan
