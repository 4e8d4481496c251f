// SPDX-License-Identifier: Apache-2.0
// Voxel-grid downsampling: near and far surfaces get equal weight, and registration costs the same for every scan.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "scan/scan.hpp"

namespace cluxel::scan {

struct ThinningParams {
  double voxel_m = 0.3;  ///< edge of a cube; grows by a quarter until no more than `max_points` are left
  std::size_t max_points = 25'000;
};

/// The mean of the points of each cube, in the sensor frame [m], in the order of the cubes. Cost: sorts the points.
std::vector<Eigen::Vector3f> thinnedToVoxels(const ScanPoints& points, const ThinningParams& params);

}  // namespace cluxel::scan
