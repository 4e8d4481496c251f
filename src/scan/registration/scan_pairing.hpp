// SPDX-License-Identifier: Apache-2.0
// Chooses the pairs of scans to register.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <utility>
#include <vector>

namespace cluxel::scan {

using ScanPair = std::pair<std::size_t, std::size_t>;  ///< the smaller number first

/// Where a scan stands and what it covers, in the map frame [m].
struct ScanPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::AlignedBox3d box;
};

/// Each scan with its two nearest, and the minimum spanning forest of scans whose boxes overlap; sorted.
std::vector<ScanPair> nearestPairs(const std::vector<ScanPlace>& places);

/// Also pairs each scan with two others in each doubling of the distance to its nearest one, so that small errors do
/// not accumulate along a drive. `reach_m` bounds the distance.
std::vector<ScanPair> widerPairs(const std::vector<ScanPlace>& places, double reach_m);

}  // namespace cluxel::scan
