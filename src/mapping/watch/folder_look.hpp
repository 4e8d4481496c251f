// SPDX-License-Identifier: Apache-2.0
// One look at a folder in which scans arrive: what two looks have alike is not being written.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scan/scan_set.hpp"

namespace cluxel::mapping {

/// Tells a file that was changed or replaced, also by one of the same size and time.
struct FileState {
  std::uint64_t device = 0, inode = 0, size = 0;
  std::int64_t written_ns = 0, changed_ns = 0;  ///< when its content, and when anything about it, changed
  bool operator==(const FileState&) const = default;
};
using FolderState = std::map<std::filesystem::path, FileState>;

/// Follows links; absent when there is no such file.
std::optional<FileState> stateOfFile(const std::filesystem::path& file);

/// What the folder tells of a scan beside its points.
struct Placement {
  bool has_pose = false;
  Eigen::Matrix4d T_map_sensor = Eigen::Matrix4d::Identity();
  std::optional<double> time_s;
  bool operator==(const Placement&) const = default;
};

struct SeenScan {
  FileState file;
  Placement place;
  bool operator==(const SeenScan&) const = default;
};

/// A scan that was left out of the set.
struct FaultySeen {
  FileState file;
  std::string fault;
  bool operator==(const FaultySeen&) const = default;
};

struct FolderLook {
  bool is_there = false;                               ///< the folder, or what has its name
  FolderState files;                                   ///< below the folder, without those that vanish meanwhile
  std::optional<scan::ScanSet> scans;                  ///< absent when the folder cannot be read as a set of scans
  std::map<std::filesystem::path, SeenScan> seen;      ///< the scans by path; they may lie outside of the folder
  std::map<std::filesystem::path, FaultySeen> faulty;  ///< by path
  std::string fault;                                   ///< why there is no set; empty for an empty folder
  std::vector<std::string> notes;                      ///< on the set

  bool hasScan(const std::filesystem::path& path) const { return seen.contains(path) || faulty.contains(path); }
  /// The files that are no scans, such as those of poses.
  FolderState sideFiles() const;
};

/// `params` are those of a set whose faulty scans are left out.
FolderLook lookAt(const std::filesystem::path& folder, const scan::ScanSetParams& params);

}  // namespace cluxel::mapping
