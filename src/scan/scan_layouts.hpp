// SPDX-License-Identifier: Apache-2.0
// What the files of a folder mean: KITTI odometry, Freiburg/Behley, or a plain folder of scan files.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/base/progress.hpp"
#include "cluxel/scan/scan_set.hpp"
#include "scan/pose_files.hpp"

namespace cluxel {

/// A scan, and the line of the folder's poses file and times file that belongs to it.
struct LayoutScan {
  ScanFile file;
  std::size_t frame = 0;
};

struct FolderLayout {
  std::vector<LayoutScan> scans;  ///< by name, in natural order; poses not yet attached
  std::optional<std::filesystem::path> poses_file;
  std::optional<std::filesystem::path> times_file;
  bool frames_are_numbers = false;                   ///< `frame` comes from the file's name (KITTI), not its rank
  bool poses_in_camera = false;                      ///< poses are of the camera (KITTI)
  std::optional<Eigen::Isometry3d> T_camera_sensor;  ///< KITTI's Tr
};

/// The layout of a folder; InputError when there are no scans in it.
FolderLayout layoutOfFolder(const std::filesystem::path& folder);

/// The folder whose layout explains a lone scan file (its own, or that of velodyne/); absent when none does.
std::optional<std::filesystem::path> layoutFolderOf(const std::filesystem::path& scan);

/// The format of a scan file, by its name and for texts by its first line; InputError for unknown ones.
ScanFormat formatOf(const std::filesystem::path& scan);

/// Gives each scan its time and its pose from the folder's files; InputError when a scan has no line in one
/// of them.
void attachTimes(FolderLayout& layout);
void attachPoses(FolderLayout& layout, ProgressSink& sink);

/// Gives `scans` the poses of a list: by time when both have times (10 ms), else by frame.
void assignPoses(std::vector<LayoutScan*> scans, const PoseList& list, const std::string& poses_file,
                 bool frames_are_numbers);

/// `T_map_sensor = Tr⁻¹ · P · Tr` for a pose P of KITTI's camera.
Eigen::Isometry3d sensorPoseFromCamera(const Eigen::Isometry3d& camera_pose, const Eigen::Isometry3d& T_camera_sensor);

/// "scan_2" before "scan_10": runs of digits compare as numbers.
bool naturalLess(const std::string& a, const std::string& b);

}  // namespace cluxel
