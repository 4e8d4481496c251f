// SPDX-License-Identifier: Apache-2.0
// One scan of a map: the paper's cloud layer.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "perception/segments/scene.hpp"
#include "scan/scan.hpp"

namespace cluxel::mapping {

struct Cloud {
  scan::ScanId id;
  std::string source;  ///< source file; history, not part of the map function
  std::optional<double> time_s;
  Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
  bool has_pose = false;
  bool has_ray_starts = false;  ///< a pose or the origins of its points tell where its rays start
  std::uint64_t point_count = 0;
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();  ///< bounds of its points [m, map]
  /// Bounds of its rays, from their origins to the points [m, map]. Endless in maps of versions that did not store
  /// them.
  Eigen::AlignedBox3d rays{Eigen::Vector3d(Eigen::Vector3d::Constant(-1e300)),
                           Eigen::Vector3d(Eigen::Vector3d::Constant(1e300))};
  std::optional<perception::SensorSight> sight;  ///< absent when the place of the sensor is unknown
};

/// The views of the clouds whose sensor's place is known.
std::vector<perception::SceneView> viewsOf(const std::vector<Cloud>& clouds);
std::vector<scan::ScanId> idsOf(const std::vector<Cloud>& clouds);

}  // namespace cluxel::mapping
