// SPDX-License-Identifier: Apache-2.0
// Scans of two places that are far apart, and whose rays pass the objects of the other place.
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "mapping/small_campus.hpp"

namespace cluxel::mapping {

/// Moves a scan, and lets a ray of it end at a place [m, map]: all that lies between may have been passed.
inline scan::Scan movedWithRay(scan::Scan scan, const Eigen::Vector3d& by, const Eigen::Vector3d& end_map) {
  scan.T_map_sensor.pretranslate(by);
  const Eigen::Vector3d end = scan.T_map_sensor.inverse() * end_map;
  scan::ScanPoints& points = scan.points;
  points.x.push_back(static_cast<float>(end.x()));
  points.y.push_back(static_cast<float>(end.y()));
  points.z.push_back(static_cast<float>(end.z()));
  if (!points.intensity.empty()) points.intensity.push_back(0.5F);
  if (!points.label.empty()) points.label.push_back(0);
  return scan;
}

/// Six scans with times. The last three lie 150 m east of the first ones, and rays of each place end beyond the other.
class FarRays {
 public:
  FarRays() {
    const Eigen::Vector3d first = campus_.scans()[0].scan.T_map_sensor.translation();
    for (std::size_t i = 0; i < campus_.files().size(); ++i) {
      const double y = 20.0 * static_cast<double>(i % 3) - 20;
      const bool is_east = i >= 3;
      files_.push_back(folder_.path() / ("scan" + std::to_string(i) + ".pcd"));
      writeScanFile(movedWithRay(campus_.scans()[i].scan, {is_east ? 150.0 : 0.0, 0, 0},
                                 first + Eigen::Vector3d(is_east ? -120.0 : 270.0, y, 2)),
                    files_.back());
    }
  }

  scan::ScanSet scans(std::size_t from, std::size_t to) const {
    std::ofstream text(folder_.path() / "scans.yaml");
    text << "scans:\n";
    for (std::size_t i = from; i < to; ++i)
      text << "  - {path: " << files_[i].string() << ", time_s: " << 1600000000 + 1000 * i << "}\n";
    text.close();
    return scansOf({folder_.path() / "scans.yaml"});
  }
  std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }

 private:
  SmallCampus campus_{{.seed = 1, .stops = 6, .size_m = 80, .points_per_stop = 5000, .max_range_m = 16}};
  ScratchFolder folder_;
  std::vector<std::filesystem::path> files_;
};

}  // namespace cluxel::mapping
