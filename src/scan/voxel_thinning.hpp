// SPDX-License-Identifier: Apache-2.0
// One point for each small cube of space: near and far surfaces then count alike, and a registration costs the same for
// every scan.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "cluxel/scan/scan.hpp"

namespace cluxel {

struct ThinningParams {
  double voxel_m = 0.3;  ///< edge of a cube; grows by a quarter until no more than `most_points` are left
  std::size_t most_points = 25'000;
};

/// The mean of the points of each cube, in the sensor frame [m], in the order of the cubes. Cost: sorts the points.
std::vector<Eigen::Vector3f> thinnedToVoxels(const ScanPoints& points, const ThinningParams& params);

}  // namespace cluxel
