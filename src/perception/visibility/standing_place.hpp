// SPDX-License-Identifier: Apache-2.0
// Whether a scan looked at a place where something may stand: nothing measured of a thing is needed.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "perception/visibility/scan_rays.hpp"

namespace cluxel::perception {

/// Where a thing would stand: an upright line from the ground upwards.
struct StandingPlace {
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();  ///< on the ground [m, map]
  double height_m = 1;                             ///< of the thing

  /// The top, at least 0.3 m and at most 30 m above the foot: no thing that stands is higher.
  double top_m() const;
};

/// The points of the line that rays are compared with [m, map]: the foot, then every 0.3 m up to the top, and the top
/// where it is more than 0.15 m above the last of them. So each ray that meets the line passes one within 0.15 m.
std::vector<Eigen::Vector3d> pointsOf(const StandingPlace& place);

/// Whether the rays that start within `view_m` of the place, across the ground, tell what is there: one that passes it
/// within half a metre ended `hit_m` before or behind it, or nearer; or `min_rays` that start in one square of 2 m
/// passed it above the foot, and no more of those near it ended before it. A thing that stands behind a wall and looks
/// over it is seen when more of it is seen than is hidden. Where no ray returns, those count that something there would
/// return (RayBundle::returnsMissing). A steep ray counts at each point that it is near. Cost: for each point that of
/// ScanRays::verdictAt().
bool looksAt(const ScanRays& rays, const StandingPlace& place, double view_m, const RayParams& params = {});

}  // namespace cluxel::perception
