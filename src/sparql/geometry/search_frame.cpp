// SPDX-License-Identifier: Apache-2.0
// Places geometries of named coordinate systems in planes in metres.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include "sparql/geometry/search_frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sparql/geometry/geometry_parts.hpp"

namespace cluxel::sparql {
namespace {

/// Longer edges have no box: half an edge is the margin of a box.
constexpr double kLongestEdge = 500'000;
/// Geometries below this height over the plane, as a cosine, have no box: the projection folds at the horizon.
constexpr double kLeastCosine = 0.5;

double product(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Calls `take(points)` for every sequence of points, and `take_point` for single points.
template <typename TakePoint, typename TakePath>
void forEachPath(const Geometry& geometry, const TakePoint& take_point, const TakePath& take_path) {
  for (const PlanePoint& point : geometry.points) take_point(point);
  for (const PlaneLine& line : geometry.lines) take_path(line);
  for (const PlanePolygon& polygon : geometry.polygons) {
    take_path(polygon.outer());
    for (const auto& ring : polygon.inners()) take_path(ring);
  }
}

}  // namespace

std::optional<Box2> SearchFrame::boxOf(const Geometry& geometry) {
  if (system_.kind == ReferenceSystem::Kind::Geographic) return boxOnEarth(geometry);
  if (system_.kind != ReferenceSystem::Kind::Projected) return std::nullopt;
  const Box2 box = planeBoxOf(geometry);
  const double unit = system_.metres_per_unit;
  return Box2{box.min_x * unit, box.min_y * unit, box.max_x * unit, box.max_y * unit};
}

/// The point on the ellipsoid [m]; absent for impossible coordinates and for places far from the first one.
std::optional<SearchFrame::Vector> SearchFrame::placed(double first, double second) {
  const double to_radians = system_.degrees_per_unit * std::numbers::pi / 180;
  const double latitude = (system_.latitude_first ? first : second) * to_radians;
  const double longitude = (system_.latitude_first ? second : first) * to_radians;
  if (!(std::abs(latitude) <= std::numbers::pi / 2) || !(std::abs(longitude) <= 2 * std::numbers::pi))
    return std::nullopt;
  const double flattening = system_.inverse_flattening > 0 ? 1 / system_.inverse_flattening : 0;
  const double squared_eccentricity = flattening * (2 - flattening);
  const Vector normal = {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                         std::sin(latitude)};
  if (!has_origin_) {
    has_origin_ = true;
    up_ = normal;
    east_ = {-std::sin(longitude), std::cos(longitude), 0};
    north_ = {-std::sin(latitude) * std::cos(longitude), -std::sin(latitude) * std::sin(longitude), std::cos(latitude)};
  }
  if (product(normal, up_) < kLeastCosine) return std::nullopt;
  const double radius_m = system_.semi_major_axis_m / std::sqrt(1 - squared_eccentricity * normal[2] * normal[2]);
  return Vector{radius_m * normal[0], radius_m * normal[1], radius_m * (1 - squared_eccentricity) * normal[2]};
}

/// An edge is the shortest way for distances and a line in the plane of the coordinates for relations. Neither is
/// longer than the latter, so that every point of it is at most half of that from one of its ends.
std::optional<Box2> SearchFrame::boxOnEarth(const Geometry& geometry) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  // A degree of latitude is longest at the poles, by a hundredth.
  const double metres_per_unit = system_.semi_major_axis_m * 1.01 * system_.degrees_per_unit * std::numbers::pi / 180;
  Box2 box{kFar, kFar, -kFar, -kFar};
  bool all_placed = true;
  double longest_m = 0;
  const auto grow = [&](const PlanePoint& point) {
    const auto place = placed(point.x(), point.y());
    all_placed = all_placed && place;
    if (!place) return;
    const double x = product(*place, east_), y = product(*place, north_);
    box = {std::min(box.min_x, x), std::min(box.min_y, y), std::max(box.max_x, x), std::max(box.max_y, y)};
  };
  forEachPath(geometry, grow, [&](const auto& path) {
    for (std::size_t i = 0; i < path.size(); ++i) {
      grow(path[i]);
      if (i == 0) continue;
      const double edge = std::hypot(path[i].x() - path[i - 1].x(), path[i].y() - path[i - 1].y());
      longest_m = std::max(longest_m, edge * metres_per_unit);
    }
  });
  if (!all_placed || longest_m > kLongestEdge || box.min_x > box.max_x) return std::nullopt;
  constexpr double kRoundingOfLines = 0.01;
  const double margin = longest_m > 0 ? longest_m / 2 + kRoundingOfLines : 0;
  return Box2{box.min_x - margin, box.min_y - margin, box.max_x + margin, box.max_y + margin};
}

}  // namespace cluxel::sparql
