// SPDX-License-Identifier: Apache-2.0
// Scans of a generated campus whose sensors' places are known, or not, and sets of them with other poses.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <utility>

#include "mapping/small_campus.hpp"

namespace cluxel::mapping {

/// Of a laser that sees nothing above 2 degrees. Every second scan lies in the map frame without a pose; of these every
/// second has ray origins.
class MixedScans {
 public:
  using Place = std::pair<std::size_t, std::optional<int>>;  ///< scan, number of its pose; absent: as measured

  MixedScans() : campus_({.seed = 5, .stops = 4, .size_m = 45, .points_per_stop = 4000}) {
    for (std::size_t i = 0; i < campus_.scans().size(); ++i) {
      Scan scan = campus_.scans()[i].scan;
      keepBelow(scan.points, 2);
      if (i % 2 == 1) intoMapFrame(scan, i % 4 == 1);
      files_.push_back(folder_.path() / ("scan" + std::to_string(i) + ".pcd"));
      writeScanFile(scan, files_.back());
      const ScanSet alone = scansOf({files_.back()});
      ids_.push_back(alone.load(0).id);
      poses_.push_back(alone.file(0).T_map_sensor);
    }
  }
  std::size_t size() const { return files_.size(); }
  /// Of some the place of the sensor is known, of some also where its rays end upwards, of some nothing.
  void expectAllKinds() const {
    std::size_t placed = 0, edged = 0;
    for (const std::filesystem::path& file : files_) {
      const auto sight = perception::sensorSightOf(scansOf({file}).load(0));
      placed += sight ? 1 : 0, edged += sight && sight->upper_edge ? 1 : 0;
    }
    EXPECT_LT(placed, files_.size());
    EXPECT_GT(edged, 0U) << placed;
  }
  const ScanId& idOf(std::size_t scan) const { return ids_[scan]; }
  /// Number 0 is the true pose.
  Eigen::Isometry3d poseOf(std::size_t scan, int number) const {
    Eigen::Isometry3d T = poses_[scan];
    if (number == 0) return T;
    T.pretranslate(Eigen::Vector3d(0.5 * number, 0.25, 0));
    T.rotate(Eigen::AngleAxisd(number * 0.035, Eigen::Vector3d::UnitZ()));
    return T;
  }
  /// The scans at these places in this order, by a manifest in `folder`.
  ScanSet at(const std::vector<Place>& places, const std::filesystem::path& folder) const {
    std::ofstream text(folder / "places.yaml");
    text.precision(17);
    text << "scans:\n";
    for (const auto& [scan, number] : places) {
      text << "  - {path: " << files_[scan].string() << ", time_s: " << 1600000000 + 1000 * scan;
      if (number) text << ", pose: " << rows(poseOf(scan, *number));
      text << "}\n";
    }
    text.close();
    return scansOf({folder / "places.yaml"});
  }

 private:
  static void keepBelow(ScanPoints& points, float degrees) {
    const float slope = std::tan(degrees / 180 * std::numbers::pi_v<float>);
    ScanPoints kept;
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (points.z[p] > slope * std::hypot(points.x[p], points.y[p])) continue;
      kept.x.push_back(points.x[p]), kept.y.push_back(points.y[p]), kept.z.push_back(points.z[p]);
    }
    points = std::move(kept);
  }
  static void intoMapFrame(Scan& scan, bool with_origins) {
    for (std::size_t p = 0; p < scan.points.size(); ++p) {
      const Eigen::Vector3f at =
          toMap(scan.T_map_sensor, {scan.points.x[p], scan.points.y[p], scan.points.z[p]}).cast<float>();
      scan.points.x[p] = at.x(), scan.points.y[p] = at.y(), scan.points.z[p] = at.z();
    }
    scan.points.origin.clear();
    if (with_origins)
      scan.points.origin.assign(scan.points.size(), Eigen::Vector3f(scan.T_map_sensor.translation().cast<float>()));
    scan.T_map_sensor.setIdentity();
    scan.has_pose = false;
  }
  static std::string rows(const Eigen::Isometry3d& T) {
    std::ostringstream text;
    text.precision(17);
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        text << (column > 0 ? ", " : row > 0 ? "], [" : "[[") << T.matrix()(row, column);
    return text.str() + "]]";
  }

  ScratchFolder folder_;
  SmallCampus campus_;
  std::vector<std::filesystem::path> files_;
  std::vector<ScanId> ids_;
  std::vector<Eigen::Isometry3d> poses_;
};

}  // namespace cluxel::mapping
