// SPDX-License-Identifier: Apache-2.0
// The visible part of each object in the scans: the rows of truth/instances.csv.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "simulation/laser/laser.hpp"

namespace cluxel::simulation {

/// The points of one object in one scan or in all.
struct InstanceSight {
  std::size_t points = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  ///< of the points [m, map]
  Eigen::AlignedBox3d box;                        ///< around the points [m, map]
  std::vector<Eigen::Vector2d> outline;           ///< convex hull of the points from above [m, map]
  std::map<std::uint32_t, std::size_t> points_of_label;
};
using InstanceSights = std::map<std::int32_t, InstanceSight>;  ///< by instance id

InstanceSights sightsOf(const SimulatedScan& scan);

/// The table with the columns of `oakland3d_truth/instances.csv`: one row per object with a point; `scans`
/// names the scan of each entry. Ambiguous objects are too
/// occluded, too long or too sparsely sampled to score a map by them.
std::string instanceTable(const Campus& campus, const std::vector<InstanceSights>& sights,
                          const std::vector<std::string>& scans);

}  // namespace cluxel::simulation
