// SPDX-License-Identifier: Apache-2.0
// Constraint between the poses of two overlapping scans: the distance of their surfaces, and the motion that closes it.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "scan/registration/surface_cloud.hpp"

namespace cluxel::scan {

using Vector6d = Eigen::Matrix<double, 6, 1>;  ///< motion of a sensor in its own frame: translation [m], rotation [rad]
using Matrix6d = Eigen::Matrix<double, 6, 6>;

struct EvidenceParams {
  double reach_m = 0.5;      ///< points of the other scan further away do not count; at most SurfaceCloud::kMaxReach_m
  double tolerance_m = 0.1;  ///< scale of the robust weight: much larger gaps have little weight
};

/// Around a relative pose `T`, a motion xi of the source to T·exp(xi) costs (xi - wish)'·information·(xi - wish): the
/// mean square [m²] of what it adds to the distances between the points of one scan and the planes of the other.
/// Directions that the surfaces do not determine have no information, and `wish` is zero there.
struct PairEvidence {
  Matrix6d information = Matrix6d::Zero();
  Vector6d wish = Vector6d::Zero();  ///< the motion that this pair alone would make
  double overlap = 0;  ///< share of the scan with less overlap that has a neighbour in the other within kMaxReach_m
  double residual_m =
      0;  ///< median distance of a point to the other's plane, of surfaces that face the worst direction
};

/// The upper median for an even count; 0 for an empty list.
double medianOf(std::vector<double> values);

PairEvidence evidenceOf(const SurfaceCloud& target, const SurfaceCloud& source,
                        const Eigen::Isometry3d& T_target_source, const EvidenceParams& params);

}  // namespace cluxel::scan
