// SPDX-License-Identifier: Apache-2.0
// Depth images from where a sensor might stand, and hashed thinning.
#include "cluxel/perception/virtual_sensor.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "perception/hashed_share.hpp"

namespace cluxel {

namespace {

template <typename T>
std::vector<T> chosen(const std::vector<T>& values, const std::vector<std::size_t>& keep) {
  std::vector<T> rest;
  if (values.empty()) return rest;
  for (const std::size_t i : keep) rest.push_back(values[i]);
  return rest;
}

void keepOf(const Scan& scan, const PointTruth& truth, const std::vector<std::size_t>& keep, LabelledScans& rest) {
  const ScanPoints& points = scan.points;
  Scan copy;
  copy.points = {chosen(points.x, keep), chosen(points.y, keep), chosen(points.z, keep), chosen(points.intensity, keep),
                 chosen(points.label, keep), chosen(points.origin, keep)};
  copy.time_s = scan.time_s;
  copy.T_map_sensor = scan.T_map_sensor;
  copy.has_pose = scan.has_pose;
  copy.source = scan.source;
  copy.id = contentIdOf(copy);
  rest.scans.push_back(std::move(copy));
  rest.truth.push_back({chosen(truth.primitive, keep), {}, {}, {}});
}

/// All points of all scans in the map frame, with the truth.
struct Cloud {
  std::vector<Eigen::Vector3d> point;
  std::vector<std::int8_t> primitive;
};

Cloud cloudOf(std::span<const Scan> scans, std::span<const PointTruth> truth) {
  Cloud cloud;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const ScanPoints& points = scans[s].points;
    for (std::size_t i = 0; i < points.size(); ++i)
      cloud.point.push_back(toMap(scans[s].T_map_sensor, {points.x[i], points.y[i], points.z[i]}));
    cloud.primitive.insert(cloud.primitive.end(), truth[s].primitive.begin(), truth[s].primitive.end());
  }
  return cloud;
}

/// Where the sensor stands: over the ground point nearest to the middle of each cell, when most of the cell is ground.
std::vector<Eigen::Vector3d> standsOf(const Cloud& cloud, const VirtualSensor& sensor) {
  struct Cell {
    std::size_t points = 0, ground = 0, nearest = 0;
    double distance_m = std::numeric_limits<double>::infinity();
  };
  std::map<std::pair<std::int64_t, std::int64_t>, Cell> cells;
  for (std::size_t i = 0; i < cloud.point.size(); ++i) {
    const double x = cloud.point[i].x() / sensor.spacing_m, y = cloud.point[i].y() / sensor.spacing_m;
    Cell& cell = cells[{static_cast<std::int64_t>(std::floor(x)), static_cast<std::int64_t>(std::floor(y))}];
    ++cell.points;
    if (cloud.primitive[i] != static_cast<std::int8_t>(PrimitiveLabel::HorizontalPlane)) continue;
    ++cell.ground;
    const double distance = std::hypot(x - std::floor(x) - 0.5, y - std::floor(y) - 0.5);
    if (distance >= cell.distance_m) continue;
    cell.distance_m = distance;
    cell.nearest = i;
  }
  std::vector<Eigen::Vector3d> stands;
  for (const auto& [key, cell] : cells)
    if (cell.ground >= 200 && 2 * cell.ground > cell.points)
      stands.push_back(cloud.point[cell.nearest] + Eigen::Vector3d(0, 0, sensor.height_m));
  return stands;
}

/// Marks the nearest point of each direction.
void look(const Cloud& cloud, const Eigen::Vector3d& stand, const VirtualSensor& sensor, std::vector<bool>& seen) {
  const auto steps = static_cast<std::size_t>(std::ceil(2 * std::numbers::pi / sensor.step_rad));
  const double per_line = static_cast<double>(sensor.lines) / (sensor.highest_rad - sensor.lowest_rad);
  constexpr std::size_t nothing = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> nearest(steps * static_cast<std::size_t>(sensor.lines), nothing);
  std::vector<double> range(nearest.size(), sensor.range_m);
  for (std::size_t i = 0; i < cloud.point.size(); ++i) {
    const Eigen::Vector3d ray = cloud.point[i] - stand;
    const double distance = ray.norm();
    if (distance < 1.0 || distance >= sensor.range_m) continue;
    const double line = (std::asin(ray.z() / distance) - sensor.lowest_rad) * per_line;
    if (line < 0 || line >= sensor.lines) continue;
    const double turn = (std::atan2(ray.y(), ray.x()) + std::numbers::pi) / sensor.step_rad;
    const std::size_t at = static_cast<std::size_t>(line) * steps + std::min(static_cast<std::size_t>(turn), steps - 1);
    if (distance >= range[at]) continue;
    range[at] = distance;
    nearest[at] = i;
  }
  for (const std::size_t i : nearest)
    if (i != nothing) seen[i] = true;
}

}  // namespace

LabelledScans thinned(std::span<const Scan> scans, std::span<const PointTruth> truth, double share, std::uint64_t seed) {
  LabelledScans rest;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    std::vector<std::size_t> keep;
    for (std::size_t i = 0; i < scans[s].points.size(); ++i)
      if (hashedShare(seed, 0, i) < share) keep.push_back(i);
    if (!keep.empty()) keepOf(scans[s], truth[s], keep, rest);
  }
  return rest;
}

std::vector<VirtualSensor> spinningSensors() {
  return {{.highest_rad = 0.06, .spacing_m = 60, .range_m = 45},
          {.highest_rad = 0.03, .spacing_m = 40, .range_m = 45},
          {.highest_rad = 0.05, .spacing_m = 4, .range_m = 30},
          {.height_m = 1.2, .lowest_rad = -0.26, .highest_rad = 0.26, .lines = 32, .spacing_m = 20}};
}

LabelledScans seenBy(std::span<const Scan> scans, std::span<const PointTruth> truth, const VirtualSensor& sensor) {
  const Cloud cloud = cloudOf(scans, truth);
  std::vector<bool> seen(cloud.point.size(), false);
  for (const Eigen::Vector3d& stand : standsOf(cloud, sensor)) look(cloud, stand, sensor, seen);
  LabelledScans rest;
  std::size_t first = 0;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    std::vector<std::size_t> keep;
    for (std::size_t i = 0; i < scans[s].points.size(); ++i)
      if (seen[first + i]) keep.push_back(i);
    first += scans[s].points.size();
    if (!keep.empty()) keepOf(scans[s], truth[s], keep, rest);
  }
  return rest;
}

}  // namespace cluxel
