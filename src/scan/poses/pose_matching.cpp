// SPDX-License-Identifier: Apache-2.0
// Matches poses and times with the scans of a folder.
#include <algorithm>
#include <cmath>

#include "base/file_bytes.hpp"
#include "base/text/short_number.hpp"
#include "cluxel/error.hpp"
#include "scan/scan_layouts.hpp"

namespace cluxel::scan {

namespace {

/// The clocks of laser and pose source are rounded differently. Scans at 10 Hz are ten times further apart.
constexpr double kTimeTolerance_s = 0.010;

std::size_t nearestTime(const std::vector<double>& times, double time_s) {
  const auto nearest = std::min_element(
      times.begin(), times.end(), [&](double a, double b) { return std::abs(a - time_s) < std::abs(b - time_s); });
  return static_cast<std::size_t>(nearest - times.begin());
}

void setPose(LayoutScan& scan, const Eigen::Isometry3d& pose) {
  scan.file.T_map_sensor = pose;
  scan.file.has_pose = true;
}

void assignByTime(const std::vector<LayoutScan*>& scans, const PoseList& list, const std::string& poses_file) {
  for (LayoutScan* scan : scans) {
    const std::size_t i = nearestTime(list.time_s, *scan->file.time_s);
    const double off_s = std::abs(list.time_s[i] - *scan->file.time_s);
    if (off_s > kTimeTolerance_s)
      throw InputError({.file = poses_file},
                       "has no pose for " + scan->file.path.string() + ": the nearest is " + shortNumber(off_s) +
                           " s away from its time",
                       "a pose within 0.01 s of every scan is needed");
    setPose(*scan, list.poses[i]);
  }
}

/// Throws InputError when the number of lines does not fit the scans. Each scan needs one line; where file names are
/// frame numbers, there must be a line for the highest frame.
void checkCounts(const std::vector<LayoutScan*>& scans, std::size_t lines, const char* what, const std::string& file,
                 bool frames_are_numbers) {
  for (const LayoutScan* scan : scans)
    if (scan->frame >= lines)
      throw InputError({.file = file}, "has no " + std::string(what) + " for " + scan->file.path.string() +
                                           ": it has " + std::to_string(lines) + " lines and the scan is number " +
                                           std::to_string(scan->frame) + " (from 0)");
  if (!frames_are_numbers && lines != scans.size())
    throw InputError({.file = file},
                     "has " + std::to_string(lines) + ' ' + what + "s for " + std::to_string(scans.size()) + " scans",
                     "one line for each scan is needed, in the natural order of their names");
}

}  // namespace

void assignPoses(std::vector<LayoutScan*> scans, const PoseList& list, const std::string& poses_file,
                 bool frames_are_numbers) {
  const bool timed =
      std::all_of(scans.begin(), scans.end(), [](const LayoutScan* s) { return s->file.time_s.has_value(); });
  if (timed && !list.time_s.empty()) return assignByTime(scans, list, poses_file);
  checkCounts(scans, list.poses.size(), "pose", poses_file, frames_are_numbers);
  for (LayoutScan* scan : scans) {
    setPose(*scan, list.poses[scan->frame]);
    if (!list.time_s.empty() && !scan->file.time_s) scan->file.time_s = list.time_s[scan->frame];
  }
}

void attachTimes(FolderLayout& layout) {
  if (!layout.times_file) return;
  const std::string file = layout.times_file->string();
  const std::vector<double> times = parseTimes(readFile(*layout.times_file), file);
  std::vector<LayoutScan*> scans;
  for (LayoutScan& scan : layout.scans) scans.push_back(&scan);
  checkCounts(scans, times.size(), "time", file, layout.frames_are_numbers);
  for (LayoutScan* scan : scans) scan->file.time_s = times[scan->frame];
}

void attachPoses(FolderLayout& layout, ProgressSink& sink) {
  if (!layout.poses_file) return;
  const std::string file = layout.poses_file->string();
  std::vector<LayoutScan*> scans;
  for (LayoutScan& scan : layout.scans) scans.push_back(&scan);
  assignPoses(scans, parsePoses(readFile(*layout.poses_file), file), file, layout.frames_are_numbers);
  if (!layout.poses_in_camera) return;
  if (!layout.T_camera_sensor) {
    sink.note(file +
              ": no calib.txt stands beside it, so the poses are taken as those of the laser, not of the camera");
    return;
  }
  for (LayoutScan* scan : scans)
    scan->file.T_map_sensor = sensorPoseFromCamera(scan->file.T_map_sensor, *layout.T_camera_sensor);
}

Eigen::Isometry3d sensorPoseFromCamera(const Eigen::Isometry3d& camera_pose, const Eigen::Isometry3d& T_camera_sensor) {
  return T_camera_sensor.inverse() * camera_pose * T_camera_sensor;
}

}  // namespace cluxel::scan
