// SPDX-License-Identifier: Apache-2.0
// One registered laser scan: points in the sensor frame and the pose of the sensor in the map.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/content_hash.hpp"

namespace cluxel::scan {

/// The name of a scan: the hash of what was measured (coordinates, intensities, ray origins), without time, labels,
/// pose, path and file format.
using ScanId = ContentHash;

/// The label of a point that has none. Files write -1, or this number where labels are unsigned.
inline constexpr std::uint32_t kNoLabel = 0xFFFFFFFFU;

/// Points farther than this from the map's origin are refused: a wrong pose or unit [m].
inline constexpr double kMaxCoordinate_m = 1e7;
/// The same for heights, which stay absolute [m].
inline constexpr double kMaxHeight_m = 2e4;

/// The points of a scan as a structure of arrays, in metres in the sensor frame (REP-103: x forward, y left, z up).
/// Optional arrays are either empty or as long as `x`.
struct ScanPoints {
  std::vector<float> x, y, z;
  std::vector<float> intensity;
  std::vector<std::uint32_t> label;     ///< the data set's own label ids, or kNoLabel
  std::vector<Eigen::Vector3f> origin;  ///< where each ray started, in the sensor frame [m]

  std::size_t size() const { return x.size(); }
  bool empty() const { return x.empty(); }
};

struct Scan {
  ScanPoints points;
  std::optional<double> time_s;  ///< seconds since 1970-01-01 UTC; absent when the scan has no time
  Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
  bool has_pose = false;  ///< false: points are taken as given in the map frame, no sensor origin
  std::string source;     ///< the file it was read from, for messages
  ScanId id;              ///< contentIdOf(*this)
};

/// The content hash that names a scan.
ScanId contentIdOf(const Scan& scan);

/// `p_map = double(T_map_sensor) · p_sensor`: the one place where points change from the sensor to the map frame [m].
inline Eigen::Vector3d toMap(const Eigen::Isometry3d& T_map_sensor, const Eigen::Vector3f& p_sensor) {
  return T_map_sensor * p_sensor.cast<double>();
}

/// Whether a map can hold a point there; false for what is not a number.
inline bool isInMapRange(const Eigen::Vector3d& p_map) {
  return std::abs(p_map.x()) <= kMaxCoordinate_m && std::abs(p_map.y()) <= kMaxCoordinate_m &&
         std::abs(p_map.z()) <= kMaxHeight_m;
}

/// Refuses a scan because of a point that is not isInMapRange().
[[noreturn]] void refusePointOutOfRange(const Scan& scan, std::size_t point);
/// Refuses a scan that has such a point. Cost: one pass over the coordinates.
void requireInMapRange(const Scan& scan);

}  // namespace cluxel::scan
