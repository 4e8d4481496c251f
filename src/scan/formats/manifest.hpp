// SPDX-License-Identifier: Apache-2.0
// A manifest: a YAML file that lists scans with poses, times, and the place of the map frame in the world.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/yaml/fault_list.hpp"
#include "cluxel/error.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::scan {

/// A path that a manifest names, and where. Relative paths begin at the folder of the manifest.
struct ManifestPath {
  std::filesystem::path path;
  SourceLocation at;
};

struct ManifestEntry {
  ManifestPath path;                      ///< a scan file or a folder
  std::optional<Eigen::Isometry3d> pose;  ///< in the frame that `poses_in_outer` says
  std::optional<double> time_s;
  std::optional<ManifestPath> labels;
  std::optional<ScanFormat> format;
};

struct Manifest {
  std::vector<ManifestEntry> scans;
  std::optional<ManifestPath> poses;          ///< one poses file for all scans
  std::optional<Eigen::Vector3d> map_origin;  ///< [m] in the outer frame
  std::string crs;
  bool poses_in_outer = false;  ///< poses (and scans without one) are in the outer frame
};

/// Reads what can be read, and adds every fault of the text. `folder` is where relative paths start.
Manifest parseManifest(std::string_view text, const std::string& file, const std::filesystem::path& folder,
                       FaultList& faults);

/// Throws InputError with every fault of the text.
Manifest parseManifest(std::string_view text, const std::string& file, const std::filesystem::path& folder);

}  // namespace cluxel::scan
