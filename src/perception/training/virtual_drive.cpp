// SPDX-License-Identifier: Apache-2.0
// Stops of a drive over ground, the scan of each stop, and the drift of the poses.
#include "perception/training/virtual_drive.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "base/mixed_bits.hpp"
#include "perception/training/depth_image.hpp"

namespace cluxel::perception {

namespace {

constexpr std::uint64_t kNoiseSeed = 23;

bool isGround(const PlaceCloud& cloud, std::size_t i) {
  return cloud.primitive[i] == static_cast<std::int8_t>(scan::PrimitiveLabel::HorizontalPlane);
}

/// The horizontal direction in which the true ground is longest.
double headingOf(const PlaceCloud& cloud) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  double count = 0;
  for (std::size_t i = 0; i < cloud.point.size(); ++i) {
    if (!isGround(cloud, i)) continue;
    const Eigen::Vector2d p = (cloud.point[i] - cloud.point.front()).head<2>();
    sum += p;
    products += p * p.transpose();
    ++count;
  }
  if (count == 0) return 0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(products / count - sum * sum.transpose() / (count * count));
  const Eigen::Vector2d longest = axes.eigenvectors().col(1);
  return std::atan2(longest.y(), longest.x());
}

/// Mean height of the true ground per square metre.
class GroundHeights {
 public:
  explicit GroundHeights(const PlaceCloud& cloud) {
    for (std::size_t i = 0; i < cloud.point.size(); ++i) {
      if (!isGround(cloud, i)) continue;
      auto& [sum, count] = cells_[keyOf(cloud.point[i])];
      sum += cloud.point[i].z();
      ++count;
    }
  }

  std::optional<double> at(const Eigen::Vector3d& p) const {
    const auto cell = cells_.find(keyOf(p));
    if (cell == cells_.end()) return std::nullopt;
    return cell->second.first / cell->second.second;
  }

 private:
  using Key = std::pair<std::int64_t, std::int64_t>;
  static Key keyOf(const Eigen::Vector3d& p) {
    return {static_cast<std::int64_t>(std::floor(p.x())), static_cast<std::int64_t>(std::floor(p.y()))};
  }
  std::map<Key, std::pair<double, double>> cells_;
};

/// The true poses of the scans of one drive, with `start` in the middle: x forward, z up. Where no ground is known, the
/// height of the previous scan is used.
std::vector<Eigen::Isometry3d> posesFrom(const Eigen::Vector3d& start, double heading_rad, const GroundHeights& ground,
                                         const VirtualDrive& drive) {
  const Eigen::AngleAxisd turn(heading_rad, Eigen::Vector3d::UnitZ());
  std::vector<Eigen::Isometry3d> poses;
  double height_m = start.z() - drive.sensor.height_m;
  for (int k = 0; k < drive.scans; ++k) {
    Eigen::Vector3d stand = start + turn * Eigen::Vector3d((k - 0.5 * drive.scans) * drive.step_m, 0, 0);
    height_m = ground.at(stand).value_or(height_m);
    stand.z() = height_m + drive.sensor.height_m;
    poses.push_back(Eigen::Translation3d(stand) * turn);
  }
  return poses;
}

/// The (drifted) pose that the drive reports for scan `k`.
Eigen::Isometry3d drifted(const Eigen::Isometry3d& pose, int k, const VirtualDrive& drive) {
  return pose * (Eigen::Translation3d(k * drive.drift_forward_m, k * drive.drift_sideways_m, 0) *
                 Eigen::AngleAxisd(k * drive.drift_yaw_rad, Eigen::Vector3d::UnitZ()));
}

/// Approximately normal: the sum of four uniform numbers.
double noiseOf(std::uint64_t stop, std::size_t point) {
  double sum = -2;
  for (std::uint64_t part = 0; part < 4; ++part) sum += hashedShare(kNoiseSeed + part, stop, point);
  return sum * std::numbers::sqrt3;
}

void addScan(const PlaceCloud& cloud, const Eigen::Isometry3d& pose, const Eigen::Isometry3d& stated,
             std::uint64_t stop, const VirtualDrive& drive, LabelledScans& copy) {
  scan::Scan scan;
  scan::PointTruth truth;
  for (const std::size_t i : nearestPoints(cloud, pose.translation(), drive.sensor)) {
    const Eigen::Vector3d ray = pose.inverse() * cloud.point[i];
    const Eigen::Vector3f p = (ray * (1 + drive.range_noise_m * noiseOf(stop, i) / ray.norm())).cast<float>();
    scan.points.x.push_back(p.x());
    scan.points.y.push_back(p.y());
    scan.points.z.push_back(p.z());
    truth.primitive.push_back(cloud.primitive[i]);
  }
  if (scan.points.empty()) return;
  scan.T_map_sensor = stated;
  scan.has_pose = true;
  scan.source = "virtual drive";
  scan.id = contentIdOf(scan);
  copy.scans.push_back(std::move(scan));
  copy.truth.push_back(std::move(truth));
}

}  // namespace

std::vector<VirtualDrive> usualDrives() {
  return {{.scans = 12, .step_m = 0.9},
          {.scans = 10, .step_m = 1.0, .drift_forward_m = -0.04, .drift_sideways_m = 0.01, .drift_yaw_rad = 0.001},
          {.scans = 12,
           .step_m = 0.8,
           .drift_forward_m = 0.07,
           .drift_sideways_m = -0.02,
           .drift_yaw_rad = -0.002,
           .heading_rad = 0.3}};
}

LabelledScans seenAlong(std::span<const scan::Scan> scans, std::span<const scan::PointTruth> truth,
                        const VirtualDrive& drive) {
  const PlaceCloud cloud = placeCloud(scans, truth);
  LabelledScans copy;
  if (cloud.point.empty()) return copy;
  const GroundHeights ground(cloud);
  const double heading_rad = headingOf(cloud) + drive.heading_rad;
  std::uint64_t stop = 0;
  for (const Eigen::Vector3d& start : standsOf(cloud, drive.sensor)) {
    const auto poses = posesFrom(start, heading_rad, ground, drive);
    for (std::size_t k = 0; k < poses.size(); ++k)
      addScan(cloud, poses[k], drifted(poses[k], static_cast<int>(k), drive), stop++, drive, copy);
  }
  return copy;
}

}  // namespace cluxel::perception
