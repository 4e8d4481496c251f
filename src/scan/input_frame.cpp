// SPDX-License-Identifier: Apache-2.0
// Unit and axis conversion. The ground is found as the lower envelope of the points along an axis.
#include "scan/input_frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace cluxel::scan {

namespace {

constexpr double kMaxExtent_m = 20'000;
constexpr std::size_t kSample = 10'000;

/// Columns: the axes x, y and z of the input in the frame with z up.
Eigen::Matrix3d axesOf(UpAxis up) {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  if (up == UpAxis::Y) axes << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return axes;
}

std::vector<Eigen::Vector3d> sampleOf(const Scan& scan) {
  const ScanPoints& points = scan.points;
  const std::size_t step = points.size() / kSample + 1;
  std::vector<Eigen::Vector3d> sample;
  for (std::size_t i = 0; i < points.size(); i += step)
    sample.push_back(toMap(scan.T_map_sensor, {points.x[i], points.y[i], points.z[i]}));
  return sample;
}

/// The extent along each axis without the outer 2 % of the points on each side.
Eigen::Vector3d coreExtent(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d extent;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(points.begin(), points.end(), values.begin(), [&](const Eigen::Vector3d& p) { return p[axis]; });
    const auto outer = static_cast<std::ptrdiff_t>(values.size() / 50);
    const auto low = values.begin() + outer, high = values.end() - 1 - outer;
    std::nth_element(values.begin(), low, values.end());
    std::nth_element(low, high, values.end());
    extent[axis] = *high - *low;
  }
  return extent;
}

/// The share of points at most 0.5 m above the lowest one of their cell, with `up` as the vertical axis. Cells are so
/// large that one holds ten points on average.
double groundShare(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& extent, int up) {
  constexpr double kMinCell_m = 2, kGround_m = 0.5, kPointsPerCell = 10;
  const double area_m2 = extent[(up + 1) % 3] * extent[(up + 2) % 3];
  const double cell_m = std::max(kMinCell_m, std::sqrt(kPointsPerCell * area_m2 / static_cast<double>(points.size())));
  std::map<std::pair<std::int64_t, std::int64_t>, double> lowest_m;
  const auto cellOf = [&](const Eigen::Vector3d& p) {
    const auto index = [&](int axis) { return static_cast<std::int64_t>(std::floor(p[axis % 3] / cell_m)); };
    return std::pair(index(up + 1), index(up + 2));
  };
  for (const Eigen::Vector3d& p : points) {
    const auto [cell, is_new] = lowest_m.try_emplace(cellOf(p), p[up]);
    if (!is_new) cell->second = std::min(cell->second, p[up]);
  }
  const auto on_ground = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& p) {
    return p[up] <= lowest_m.at(cellOf(p)) + kGround_m;
  });
  return static_cast<double>(on_ground) / static_cast<double>(points.size());
}

/// A scene outdoors is wide and low, and much of it is ground. A street between walls is also narrow along a horizontal
/// axis, but its lower envelope along that axis holds few points.
bool looksYUp(const Scan& scan) {
  constexpr std::size_t kFew = 1000;
  constexpr double kLow = 0.5, kMinGround = 0.3, kMoreGround = 1.5;
  const std::vector<Eigen::Vector3d> points = sampleOf(scan);
  if (points.size() < kFew) return false;
  const Eigen::Vector3d extent = coreExtent(points);
  if (extent.y() > kLow * std::min(extent.x(), extent.z())) return false;
  const double share_y = groundShare(points, extent, 1);
  return share_y > kMinGround && share_y > kMoreGround * groundShare(points, extent, 2);
}

}  // namespace

double metresPer(LengthUnit unit) {
  constexpr std::array metres{1.0, 0.01, 0.001, 0.3048, 1200.0 / 3937.0};
  return metres[static_cast<std::size_t>(unit)];
}

std::string_view nameOf(LengthUnit unit) {
  constexpr std::array<std::string_view, 5> names{"m", "cm", "mm", "ft", "us-ft"};
  return names[static_cast<std::size_t>(unit)];
}

Eigen::Vector3d toMetresZUp(const Eigen::Vector3d& p, const InputFrame& frame) {
  return metresPer(frame.unit) * (axesOf(frame.up) * p);
}

Eigen::Isometry3d toMetresZUp(const Eigen::Isometry3d& pose, const InputFrame& frame) {
  if (frame == InputFrame{}) return pose;
  const Eigen::Matrix3d axes = axesOf(frame.up);
  Eigen::Isometry3d converted = Eigen::Isometry3d::Identity();
  converted.linear() = axes * pose.linear() * axes.transpose();
  converted.translation() = toMetresZUp(Eigen::Vector3d(pose.translation()), frame);
  return converted;
}

void toMetresZUp(ScanPoints& points, const InputFrame& frame) {
  if (frame == InputFrame{}) return;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d given(points.x[i], points.y[i], points.z[i]);
    const Eigen::Vector3f p = toMetresZUp(given, frame).cast<float>();
    points.x[i] = p.x();
    points.y[i] = p.y();
    points.z[i] = p.z();
  }
  for (Eigen::Vector3f& origin : points.origin)
    origin = toMetresZUp(Eigen::Vector3d(origin.cast<double>()), frame).cast<float>();
}

std::vector<FrameDoubt> frameDoubtsOf(const Scan& scan) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    box.extend(Eigen::Vector3d(scan.points.x[i], scan.points.y[i], scan.points.z[i]));
  if (!box.isEmpty() && box.sizes().maxCoeff() > kMaxExtent_m) return {FrameDoubt::HugeExtent};
  if (looksYUp(scan)) return {FrameDoubt::YUp};
  return {};
}

}  // namespace cluxel::scan
