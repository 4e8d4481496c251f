// SPDX-License-Identifier: Apache-2.0
// One simulated scan as files: what folders of a campus and of a city have in common.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "simulation/laser/instance_table.hpp"
#include "simulation/laser/laser.hpp"

namespace cluxel::simulation {

/// Where a scan was taken, which pose the file states, and the names of its files.
struct ScanFiles {
  Eigen::Isometry3d T_map_sensor, stated;
  std::filesystem::path scan, truth;
};

/// What is left of a written scan for tables.
struct WrittenScan {
  InstanceSights sights;
  std::size_t points = 0;
};

/// Takes the scan of a stop and writes its points and its truth. Thread-safe.
WrittenScan writeScan(const Laser& laser, std::size_t stop, const ScanFiles& files);

/// The poses that the files state: those of the stops, or with `drift_m` poses with accumulated errors.
std::vector<Eigen::Isometry3d> driftedPoses(const Campus& campus);

/// Makes the folder and its subfolder truth. Error (InvalidArgument) when something is in it.
void prepareScanFolder(const std::filesystem::path& folder);

}  // namespace cluxel::simulation
