// SPDX-License-Identifier: Apache-2.0
// Layouts of folders: KITTI odometry, Freiburg/Behley, KITTI scans (.bin) alone, or any other scan files.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/progress.hpp"
#include "scan/poses/pose_files.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::scan {

/// A scan, and its line in the poses file and times file of its folder.
struct LayoutScan {
  ScanFile file;
  std::size_t frame = 0;
  std::optional<Eigen::Vector3d> outer_origin = {};  ///< of the map frame, when the pose is in an outer frame
  std::optional<InputError> fault = {};  ///< of a scan that keeps its line in the poses file, but cannot be read
  bool needs_pose = false;               ///< one of several in their own sensor frames, which make no map without poses
};

struct FolderLayout {
  std::vector<LayoutScan> scans;     ///< by name, in natural order; poses not yet attached
  std::vector<FaultyScan> misnamed;  ///< files that should be scans, but whose names tell no frame
  std::optional<std::filesystem::path> poses_file;
  std::vector<std::filesystem::path> other_poses_files;  ///< when there are several: all but `poses_file`
  std::optional<std::filesystem::path> times_file;
  bool frames_are_numbers = false;                   ///< `frame` comes from the file's name (KITTI), not its rank
  bool poses_in_camera = false;                      ///< poses are those of the camera (KITTI)
  std::optional<Eigen::Isometry3d> T_camera_sensor;  ///< KITTI's Tr
};

/// The layout of a folder. Throws InputError when it holds no scans; the fault of one scan stands beside it.
FolderLayout layoutOfFolder(const std::filesystem::path& folder);

/// The folder that may hold the pose and time of a single scan file: its own, or the parent of velodyne/.
struct OuterLayout {
  std::filesystem::path folder;
  /// The only sign is a .tum file, which may belong to something else.
  bool is_guess = false;
};
/// Absent when no file there states poses or times.
std::optional<OuterLayout> layoutFolderOf(const std::filesystem::path& scan);

/// The format of a scan file by its name, and for text by its first line. Throws InputError for an unknown format.
ScanFormat formatOf(const std::filesystem::path& scan);

/// Gives each scan its time and its pose from the folder's files. Throws InputError when a scan has no line there.
void attachTimes(FolderLayout& layout);
void attachPoses(FolderLayout& layout, ProgressSink& sink);

/// Gives `scans` the poses of a list: by time (within 10 ms) when both have times, else by frame.
void assignPoses(std::vector<LayoutScan*> scans, const PoseList& list, const std::string& poses_file,
                 bool frames_are_numbers);

/// `T_map_sensor = Tr⁻¹ · P · Tr` for a pose P of KITTI's camera.
Eigen::Isometry3d sensorPoseFromCamera(const Eigen::Isometry3d& camera_pose, const Eigen::Isometry3d& T_camera_sensor);

/// "scan_2" before "scan_10": runs of digits compare as numbers.
bool naturalLess(const std::string& a, const std::string& b);

}  // namespace cluxel::scan
