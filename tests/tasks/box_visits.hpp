// SPDX-License-Identifier: Apache-2.0
// Scans of flat ground with boxes on it, where it is known what is there when.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mapping/small_campus.hpp"

namespace cluxel::tasks {

using Box = Eigen::AlignedBox3d;

inline Box boxFrom(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return {low, high};
}

/// What a laser at some places sees at one time.
struct BoxVisit {
  std::vector<Box> boxes;
  std::vector<Eigen::Vector3d> sensors;  ///< [m, map]
  std::vector<Box> black = {};           ///< rays that end on them do not return
};

/// The range at which a ray meets a box; infinite when it does not.
inline double rangeTo(const Box& box, const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
  const Eigen::Array3d a = (box.min() - from).array() / way.array(), b = (box.max() - from).array() / way.array();
  const double enters = a.min(b).maxCoeff(), leaves = a.max(b).minCoeff();
  return enters <= leaves && enters > 0 ? enters : std::numeric_limits<double>::infinity();
}

/// Rays every 0.6 degrees around and every 1.2 degrees up to 40 degrees above and below the horizon, errors of 8 mm.
inline scan::Scan scanOf(const BoxVisit& visit, const Eigen::Vector3d& sensor, unsigned seed) {
  constexpr double kDegree = std::numbers::pi / 180;
  std::mt19937 random(seed);
  std::normal_distribution<double> error(0, 0.008);
  scan::Scan scan;
  scan.has_pose = true;
  scan.T_map_sensor = Eigen::Translation3d(sensor) * Eigen::Isometry3d::Identity();
  for (int row = 0; row < 68; ++row)
    for (int column = 0; column < 600; ++column) {
      const double up = (-40.1 + 1.2 * row) * kDegree, around = (0.6 * column + 0.1) * kDegree;
      const Eigen::Vector3d way(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up));
      double range_m = way.z() < 0 ? -sensor.z() / way.z() : std::numeric_limits<double>::infinity();
      for (const Box& box : visit.boxes) range_m = std::min(range_m, rangeTo(box, sensor, way));
      if (range_m > 40) continue;
      const Eigen::Vector3f end = ((range_m + error(random)) * way).cast<float>();
      const bool returns = std::none_of(visit.black.begin(), visit.black.end(),
                                        [&](const Box& box) { return rangeTo(box, sensor, way) <= range_m; });
      if (!returns) continue;
      scan.points.x.push_back(end.x()), scan.points.y.push_back(end.y()), scan.points.z.push_back(end.z());
    }
  return scan;
}

/// Scans in `folder`, a day from one visit to the next.
inline void writeVisits(const std::vector<BoxVisit>& visits, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::vector<Eigen::Isometry3d> poses;
  std::vector<double> times_s;
  for (std::size_t visit = 0; visit < visits.size(); ++visit)
    for (const Eigen::Vector3d& sensor : visits[visit].sensors) {
      const auto number = static_cast<unsigned>(poses.size());
      const scan::Scan scan = scanOf(visits[visit], sensor, number);
      scan::writeScanFile(scan, folder / ("scan_" + std::to_string(100 + number) + ".pcd"));
      times_s.push_back(1.7e9 + 86400.0 * static_cast<double>(visit) + 10 * number);
      poses.push_back(scan.T_map_sensor);
    }
  scan::writePoses(poses, folder / "poses.txt");
  scan::writeTimes(times_s, folder / "times.txt");
}

}  // namespace cluxel::tasks
