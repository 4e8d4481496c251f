// SPDX-License-Identifier: Apache-2.0
// Depth images of a scanned place from where a sensor might stand.
#include "perception/training/depth_image.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

namespace cluxel::perception {

PlaceCloud placeCloud(std::span<const scan::Scan> scans, std::span<const scan::PointTruth> truth) {
  PlaceCloud cloud;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const scan::ScanPoints& points = scans[s].points;
    for (std::size_t i = 0; i < points.size(); ++i)
      cloud.point.push_back(scan::toMap(scans[s].T_map_sensor, {points.x[i], points.y[i], points.z[i]}));
    cloud.primitive.insert(cloud.primitive.end(), truth[s].primitive.begin(), truth[s].primitive.end());
  }
  return cloud;
}

std::vector<Eigen::Vector3d> standsOf(const PlaceCloud& cloud, const VirtualSensor& sensor) {
  struct Cell {
    std::size_t points = 0, ground = 0, nearest = 0;
    double distance_m = std::numeric_limits<double>::infinity();
  };
  std::map<std::pair<std::int64_t, std::int64_t>, Cell> cells;
  for (std::size_t i = 0; i < cloud.point.size(); ++i) {
    const double x = cloud.point[i].x() / sensor.spacing_m, y = cloud.point[i].y() / sensor.spacing_m;
    Cell& cell = cells[{static_cast<std::int64_t>(std::floor(x)), static_cast<std::int64_t>(std::floor(y))}];
    ++cell.points;
    if (cloud.primitive[i] != static_cast<std::int8_t>(scan::PrimitiveLabel::HorizontalPlane)) continue;
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

std::vector<std::size_t> nearestPoints(const PlaceCloud& cloud, const Eigen::Vector3d& stand,
                                       const VirtualSensor& sensor) {
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
  std::erase(nearest, nothing);
  return nearest;
}

}  // namespace cluxel::perception
