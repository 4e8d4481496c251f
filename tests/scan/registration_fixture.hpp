// SPDX-License-Identifier: Apache-2.0
// Scans of places made of rectangles, sampled independently for each scan, with poses of known error.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "scan/formats/manifest_writer.hpp"
#include "scan/formats/scan_writer.hpp"
#include "scan/registration/pose_registration.hpp"
#include "scan/scan_fixture.hpp"

namespace cluxel::test {

using namespace scan;

/// A rectangle: all `corner + a·along + b·across` with a and b in [0, 1] [m].
struct Rectangle {
  Eigen::Vector3d corner, along, across;
};
using Place = std::vector<Rectangle>;

inline Place plainPlace() {
  return {{{-34, -34, 0}, {68, 0, 0}, {0, 68, 0}}};
}

/// A corridor with walls 5 m to the left and right whose ends no scan sees.
inline Place corridorPlace() {
  Place place = plainPlace();
  for (const double y : {-5.0, 5.0}) place.push_back({{-34, y, 0}, {68, 0, 0}, {0, 0, 4}});
  return place;
}

/// Walls in all directions, and crates.
inline Place yardPlace() {
  Place place = plainPlace();
  place.push_back({{-20, 9, 0}, {40, 1, 0}, {0, 0, 5}});
  place.push_back({{-18, -8, 0}, {26, -2, 0}, {0, 0, 3}});
  place.push_back({{17, -10, 0}, {1, 14, 0}, {0, 0, 4}});
  place.push_back({{-19, -4, 0}, {-1, 12, 0}, {0, 0, 4}});
  for (const double x : {-9.0, -2.0, 6.0, 12.0}) {
    place.push_back({{x, -5, 0}, {1.5, 0.3, 0}, {0, 0, 1.4}});
    place.push_back({{x, -5, 0}, {-0.3, 1.5, 0}, {0, 0, 1.4}});
  }
  return place;
}

/// Random points on the place within 25 m of the sensor, uniform by area, with 1 cm of noise.
inline Scan scanOf(const Place& place, const Eigen::Isometry3d& T_map_sensor, unsigned seed) {
  constexpr double kPerSquareMetre = 12, kRange_m = 25, kNoise_m = 0.01;
  std::mt19937 bits(seed);
  const auto share = [&] { return static_cast<double>(bits()) / 4294967296.0; };
  Scan scan;
  const Eigen::Isometry3d T_sensor_map = T_map_sensor.inverse();
  for (const Rectangle& r : place) {
    const auto count = static_cast<int>(kPerSquareMetre * r.along.cross(r.across).norm());
    for (int i = 0; i < count; ++i) {
      const double a = share(), b = share();
      Eigen::Vector3d noise;  // drawn one after the other: compilers order arguments as they like
      for (double& axis : noise) axis = 2 * kNoise_m * (share() - 0.5);
      const Eigen::Vector3d p = T_sensor_map * (r.corner + a * r.along + b * r.across + noise);
      if (p.norm() > kRange_m) continue;
      scan.points.x.push_back(static_cast<float>(p.x()));
      scan.points.y.push_back(static_cast<float>(p.y()));
      scan.points.z.push_back(static_cast<float>(p.z()));
    }
  }
  return scan;
}

inline Eigen::Isometry3d poseAt(double x, double y, double yaw_deg) {
  return Eigen::Translation3d(x, y, 1.5) * Eigen::AngleAxisd(yaw_deg * M_PI / 180, Eigen::Vector3d::UnitZ());
}

/// A motion in the sensor's frame: metres, and degrees about its axes.
inline Eigen::Isometry3d moveBy(const Eigen::Vector3d& by_m, const Eigen::Vector3d& turn_deg) {
  const double angle_deg = turn_deg.norm();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  if (angle_deg > 0) T.linear() = Eigen::AngleAxisd(angle_deg * M_PI / 180, turn_deg / angle_deg).toRotationMatrix();
  T.translation() = by_m;
  return T;
}

inline double angle_deg(const Eigen::Isometry3d& T) {
  return Eigen::AngleAxisd(T.linear()).angle() * 180 / M_PI;
}

/// Scan files whose poses are given in the files.
struct Drive {
  std::vector<Eigen::Isometry3d> truth, given;
  std::vector<fs::path> files;
};

inline Drive writeDrive(const ScratchFolder& folder, const Place& place, const std::vector<Eigen::Isometry3d>& truth,
                        const std::vector<Eigen::Isometry3d>& given) {
  Drive drive{truth, given, {}};
  for (std::size_t i = 0; i < truth.size(); ++i) {
    Scan scan = scanOf(place, truth[i], static_cast<unsigned>(100 + i));
    scan.T_map_sensor = given[i];
    drive.files.push_back(folder.path() / ("drive_" + std::to_string(i) + ".pcd"));
    writeScanFile(scan, drive.files.back());
  }
  return drive;
}

/// Refined poses in the order of the files in `drive`.
inline std::vector<Eigen::Isometry3d> refinedPoses(const Drive& drive, PoseRegistration& report, unsigned threads = 1) {
  NoteKeeper notes;
  report = registerPoses(ScanSet::open(drive.files, {}, notes), {}, threads, notes);
  std::vector<Eigen::Isometry3d> poses(drive.files.size());
  for (const RefinedScan& scan : report.scans) poses[scan.index] = scan.T_map_sensor;
  return poses;
}

/// The error of the pose of `b` relative to `a`.
inline Eigen::Isometry3d errorBetween(const std::vector<Eigen::Isometry3d>& poses,
                                      const std::vector<Eigen::Isometry3d>& truth, std::size_t a, std::size_t b) {
  return (truth[a].inverse() * truth[b]).inverse() * (poses[a].inverse() * poses[b]);
}

}  // namespace cluxel::test
