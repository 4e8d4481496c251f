// SPDX-License-Identifier: Apache-2.0
// A manifest of scans that lie where they lie, with poses of its own.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "cluxel/scan/scan_set.hpp"

namespace cluxel {

/// A scan of a set with the pose that the manifest shall give it.
struct PosedScan {
  std::size_t index = 0;  ///< in the ScanSet
  Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
};

/// The text of a manifest for `file`: scans in the order given, with path (relative to the manifest's folder), format, time,
/// labels and pose, and the set's frame. Reading it gives the same doubles. `comment` stands above, after '#'.
std::string manifestText(const ScanSet& set, const std::vector<PosedScan>& scans, const std::filesystem::path& file,
                         const std::string& comment);

}  // namespace cluxel
