// SPDX-License-Identifier: Apache-2.0
// Counts and extents of the scans of a set: shows people whether their files were understood.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scan/scan_set.hpp"

namespace cluxel::scan {

struct ScanSummary {
  std::string source;
  ScanFormat format = ScanFormat::Xyz;
  ScanId id;
  std::size_t point_count = 0;
  Eigen::AlignedBox3d extent_map_m;  ///< of the points, in the map frame
  bool has_pose = false;
  Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
  std::optional<double> time_s;
  bool has_intensity = false;
  bool has_origins = false;                              ///< an origin for each ray
  std::map<std::uint32_t, std::size_t> points_by_label;  ///< empty without labels
};

struct ScanSetSummary {
  std::vector<ScanSummary> scans;  ///< in the order of the set
  std::size_t point_count = 0;
  Eigen::AlignedBox3d extent_map_m;
  std::map<std::uint32_t, std::size_t> points_by_label;
  Eigen::Vector3d map_origin_m = Eigen::Vector3d::Zero();  ///< of the map frame in the outer frame
  std::string crs;
  std::vector<std::string> notes;  ///< on skipped records, ignored fields, and doubts about unit and axes
};

/// The summary of one loaded scan.
ScanSummary summarize(const Scan& scan, ScanFormat format);

/// Loads every scan, up to `threads` at a time, and keeps only its summary. Throws the InputError of the first faulty
/// scan.
ScanSetSummary summarize(const ScanSet& scans, unsigned threads = 1);

}  // namespace cluxel::scan
