// SPDX-License-Identifier: Apache-2.0
// Directions are sorted into cells of half a degree of azimuth and elevation by counting.
#include "perception/visibility/ray_bundle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cluxel::perception {

namespace {

constexpr int kRows = 360, kColumns = 720;
constexpr double kCell_rad = std::numbers::pi / kRows;
constexpr double kSameOrigin_m = 0.05;
constexpr double kMinRange_m = 0.3;  ///< of a place: nearer ones are the sensor's own carrier

struct Direction {
  double azimuth = 0, elevation = 0;  ///< [rad]
};

Direction directionOf(const Eigen::Vector3d& v) {
  return {std::atan2(v.y(), v.x()), std::atan2(v.z(), v.head<2>().norm())};
}

int rowOf(double elevation) {
  return std::clamp(static_cast<int>((elevation + std::numbers::pi / 2) / kCell_rad), 0, kRows - 1);
}

int columnOf(double azimuth) {
  return static_cast<int>(std::floor((azimuth + std::numbers::pi) / kCell_rad));
}

/// Columns wrap around.
std::size_t cellOf(int row, int column) {
  const int wrapped = ((column % kColumns) + kColumns) % kColumns;
  return static_cast<std::size_t>(row) * kColumns + static_cast<std::size_t>(wrapped);
}

}  // namespace

RayBundle::RayBundle(const Eigen::Vector3d& origin_map, std::vector<Eigen::Vector3f> ends)
    : origin_(origin_map), first_(static_cast<std::size_t>(kRows) * kColumns + 1, 0), rays_(ends.size()) {
  std::vector<std::uint32_t> cell(ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const Eigen::Vector3d end = ends[i].cast<double>();
    const Direction direction = directionOf(end);
    cell[i] = static_cast<std::uint32_t>(cellOf(rowOf(direction.elevation), columnOf(direction.azimuth)));
    max_range_m_ = std::max(max_range_m_, end.norm());
    ++first_[cell[i] + 1];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < ends.size(); ++i) rays_[next[cell[i]]++] = ends[i];
}

RayCounts RayBundle::countsAt(const Eigen::Vector3d& place_map, const RayParams& params) const {
  const Eigen::Vector3d place = place_map - origin_;
  const double distance_m = place.norm();
  if (distance_m < kMinRange_m || distance_m > max_range_m_ + params.hit_m) return {};
  const Direction direction = directionOf(place);
  const double half_angle = std::asin(std::min(1.0, params.near_m / distance_m));
  const int low_row = rowOf(direction.elevation - half_angle), high_row = rowOf(direction.elevation + half_angle);
  // A circle around the direction is wider in azimuth the nearer it is to the zenith.
  const double narrowest = std::cos(std::min(std::abs(direction.elevation) + half_angle, std::numbers::pi / 2));
  const double half_width = narrowest * std::numbers::pi > half_angle ? half_angle / narrowest : std::numbers::pi;
  const int low_column = columnOf(direction.azimuth - half_width);
  const int columns = std::min(columnOf(direction.azimuth + half_width) - low_column + 1, kColumns);
  RayCounts counts;
  for (int row = low_row; row <= high_row; ++row)
    for (int column = low_column; column < low_column + columns; ++column) {
      const std::size_t cell = cellOf(row, column);
      for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
        const Eigen::Vector3d end = rays_[i].cast<double>();
        const double range_m = end.norm(), along_m = place.dot(end) / range_m;
        const double aside_squared = place.squaredNorm() - along_m * along_m;
        if (along_m <= 0 || aside_squared > params.near_m * params.near_m) continue;
        if (std::abs(range_m - along_m) <= params.hit_m) ++counts.ended;
        if (range_m >= along_m + params.behind_m) ++counts.passed;
      }
    }
  return counts;
}

PlaceVerdict RayBundle::verdictAt(const Eigen::Vector3d& place_map, const RayParams& params) const {
  const RayCounts counts = countsAt(place_map, params);
  if (counts.ended + counts.passed == 0) return {};
  const bool is_sparse = counts.ended + counts.passed < static_cast<std::uint64_t>(params.min_rays);
  if (counts.ended > 0) return {RayVerdict::Hit, is_sparse};
  return {is_sparse ? RayVerdict::FewPassed : RayVerdict::SeenThrough, is_sparse};
}

void forEachRayBundle(const scan::Scan& scan, const std::function<void(const RayBundle&)>& visit) {
  const scan::ScanPoints& points = scan.points;
  if (points.origin.empty() && !scan.has_pose) return;
  Eigen::Vector3d origin = scan.T_map_sensor.translation();
  std::vector<Eigen::Vector3f> ends;
  const auto close = [&] {
    if (!ends.empty()) visit(RayBundle(origin, std::move(ends)));
    ends = {};
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points.origin.empty()) {
      const Eigen::Vector3d own = scan::toMap(scan.T_map_sensor, points.origin[i]);
      if ((own - origin).norm() > kSameOrigin_m) close();
      if (ends.empty()) origin = own;
    }
    const Eigen::Vector3d end = scan::toMap(scan.T_map_sensor, {points.x[i], points.y[i], points.z[i]}) - origin;
    if (end.squaredNorm() > 0) ends.push_back(end.cast<float>());
  }
  close();
}

}  // namespace cluxel::perception
