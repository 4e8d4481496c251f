// SPDX-License-Identifier: Apache-2.0
// The scans of maps that are to be merged: whether they fit together, before anything is computed.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mapping/clouds/cloud.hpp"

namespace cluxel::mapping {

/// What of a scan a map follows from, beside what it measured.
struct ScanInputs {
  bool has_pose = false;
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  std::optional<double> time_s;
  bool operator==(const ScanInputs&) const = default;
};

/// Adds the clouds of a map as `T_first_map` moves them; of a scan that is known the later time, as when it is stored.
/// Returns false when a scan has two poses.
bool addScanInputs(const std::vector<Cloud>& clouds, const Eigen::Isometry3d& T_first_map,
                   std::map<scan::ScanId, ScanInputs>& scans);

/// The clouds of several maps in one frame.
class ScansOfMaps {
 public:
  /// Adds those of a map as `T_first_map` moves them; `has_transform`: that was given. Throws Error (FaultyInput) when
  /// it moves points out of the range of a map, InputError when a map before holds a scan with another pose.
  void add(const std::string& map, std::vector<Cloud> clouds, const Eigen::Isometry3d& T_first_map, bool has_transform);

 private:
  std::map<scan::ScanId, std::pair<std::string, Cloud>> scans_;  ///< map and cloud
};

}  // namespace cluxel::mapping
