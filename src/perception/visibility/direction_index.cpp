// SPDX-License-Identifier: Apache-2.0
// Directions are sorted into cells of azimuth and elevation by counting.
#include "perception/visibility/direction_index.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cluxel::perception {

namespace {

struct Direction {
  double azimuth = 0, elevation = 0;  ///< [rad]
};

Direction directionOf(const Eigen::Vector3d& v) {
  return {std::atan2(v.y(), v.x()), std::atan2(v.z(), v.head<2>().norm())};
}

/// The error of the direction of a ray is less than this [rad].
constexpr double kDirectionError_rad = 1e-5;

/// Nearly std::atan2(), several times as fast: a polynomial of least maximum error (1.7e-6 rad, and rounding).
float nearlyAtan2(float y, float x) {
  const float width = std::abs(x), height = std::abs(y);
  const float larger = std::max(width, height), smaller = std::min(width, height);
  const float t = larger > 0 ? smaller / larger : 0, s = t * t;
  float angle = -0.0117191357F;
  for (const float factor : {0.0526473515F, -0.116426482F, 0.193540376F, -0.332622828F, 0.999977219F})
    angle = angle * s + factor;
  angle *= t;
  angle = height > width ? std::numbers::pi_v<float> / 2 - angle : angle;
  angle = x < 0 ? std::numbers::pi_v<float> - angle : angle;
  return std::copysign(angle, y);
}

Direction directionOfRay(const Eigen::Vector3f& v) {
  return {nearlyAtan2(v.y(), v.x()), nearlyAtan2(v.z(), v.head<2>().norm())};
}

}  // namespace

int DirectionIndex::rowOf(double elevation) const {
  return std::clamp(static_cast<int>((elevation + std::numbers::pi / 2) / (std::numbers::pi / rows_)), 0, rows_ - 1);
}

int DirectionIndex::columnOf(double azimuth) const {
  return static_cast<int>(std::floor((azimuth + std::numbers::pi) / (std::numbers::pi / rows_)));
}

std::size_t DirectionIndex::cellOf(int row, int column) const {
  const int columns = 2 * rows_, wrapped = ((column % columns) + columns) % columns;
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(wrapped);
}

DirectionIndex::DirectionIndex(std::vector<Eigen::Vector3f> ends, int rows)
    : rows_(rows),
      first_(2 * static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows) + 1, 0),
      rays_(ends.size()) {
  std::vector<std::uint32_t> cell(ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const Direction direction = directionOfRay(ends[i]);
    cell[i] = static_cast<std::uint32_t>(cellOf(rowOf(direction.elevation), columnOf(direction.azimuth)));
    ++first_[cell[i] + 1];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < ends.size(); ++i) rays_[next[cell[i]]++] = ends[i];
}

DirectionIndex::Window DirectionIndex::windowAround(const Eigen::Vector3d& place, double near_m) const {
  const Direction direction = directionOf(place);
  const double half_angle = std::asin(std::min(1.0, near_m / place.norm())) + kDirectionError_rad;
  // A circle around the direction is wider in azimuth the nearer it is to the zenith.
  const double narrowest = std::cos(std::min(std::abs(direction.elevation) + half_angle, std::numbers::pi / 2));
  const double half_width = narrowest * std::numbers::pi > half_angle ? half_angle / narrowest : std::numbers::pi;
  const int low_column = columnOf(direction.azimuth - half_width);
  return {rowOf(direction.elevation - half_angle), rowOf(direction.elevation + half_angle), low_column,
          std::min(columnOf(direction.azimuth + half_width) - low_column + 1, 2 * rows_)};
}

std::span<const Eigen::Vector3f> DirectionIndex::raysIn(int row, int column) const {
  const std::size_t cell = cellOf(row, column);
  return std::span(rays_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
}

std::vector<Eigen::Vector3f> DirectionIndex::nearestBelow(const Eigen::Vector3d& place, double near_m,
                                                          std::size_t count) const {
  const Window window = windowAround(place, near_m);
  std::vector<Eigen::Vector3f> found;
  for (int row = window.low_row; row >= 0 && found.size() < count; --row)
    for (int column = window.low_column; column < window.low_column + window.columns; ++column)
      for (const Eigen::Vector3f& ray : raysIn(row, column)) {
        // In the row of the place's own surroundings only what lies below counts.
        if (static_cast<double>(ray.z()) * place.head<2>().norm() < place.z() * ray.head<2>().cast<double>().norm())
          found.push_back(ray);
      }
  return found;
}

}  // namespace cluxel::perception
