// SPDX-License-Identifier: Apache-2.0
// Monotone chain for the hull, after points well inside an octagon of extreme points are dropped (Akl and Toussaint
// 1978). The smallest box tries the direction of every side.
#include "base/convex_hull.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/steady_angle.hpp"

namespace cluxel {

namespace {

/// Inside by less than this counts as on the border, so that rounding drops no corner [m].
constexpr double kInside_m = 1e-6;
/// Fewer points are sorted faster than filtered.
constexpr std::size_t kMinFiltered = 24;

struct LessXy {
  bool operator()(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  }
};

double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// One half of the hull of sorted points, without its last point, which belongs to the other half.
template <typename Iterator>
void appendChain(Iterator begin, Iterator end, std::vector<Eigen::Vector2d>& hull) {
  const std::size_t start = hull.size();
  for (Iterator point = begin; point != end; ++point) {
    while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), *point) <= 0) hull.pop_back();
    hull.push_back(*point);
  }
  hull.pop_back();
}

/// Erases the points inside a convex polygon, whose corners come counter-clockwise and may come more than once.
void eraseInside(const std::vector<Eigen::Vector2d>& corners, std::vector<Eigen::Vector2d>& points) {
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> sides;  // start, and the unit vector along it
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (const Eigen::Vector2d side = corners[(i + 1) % corners.size()] - corners[i]; side.norm() > kInside_m)
      sides.emplace_back(corners[i], side.normalized());
  if (sides.size() < 3) return;
  std::erase_if(points, [&](const Eigen::Vector2d& point) {
    return std::all_of(sides.begin(), sides.end(), [&](const auto& side) {
      const Eigen::Vector2d to = point - side.first;
      return side.second.x() * to.y() - side.second.y() * to.x() > kInside_m;
    });
  });
}

/// Drops the points inside the octagon whose corners are the extreme points in eight directions.
void dropInner(std::vector<Eigen::Vector2d>& points) {
  std::array<Eigen::Vector2d, 8> corner;  // counter-clockwise, as the corners of a hull; the first at the largest x
  corner.fill(points.front());
  std::array<double, 8> farthest;
  farthest.fill(-std::numeric_limits<double>::infinity());
  const auto extend = [&](std::size_t i, const Eigen::Vector2d& point, double far) {
    if (far > farthest[i]) farthest[i] = far, corner[i] = point;
  };
  for (const Eigen::Vector2d& point : points) {
    const std::array<double, 4> along{point.x(), point.x() + point.y(), point.y(), point.y() - point.x()};
    for (std::size_t i = 0; i < 4; ++i) extend(i, point, along[i]), extend(i + 4, point, -along[i]);
  }
  eraseInside({corner.begin(), corner.end()}, points);
}

/// The corners of the box along a direction, in the frame of that direction.
struct AlignedBox {
  Eigen::Vector2d direction, low, high;

  Eigen::Vector2d size() const { return high - low; }
};

AlignedBox boxAlong(const std::vector<Eigen::Vector2d>& hull, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d across(-direction.y(), direction.x());
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::Vector2d low(kInfinity, kInfinity), high(-kInfinity, -kInfinity);
  for (const Eigen::Vector2d& point : hull) {
    const Eigen::Vector2d rotated(point.dot(direction), point.dot(across));
    low = low.cwiseMin(rotated);
    high = high.cwiseMax(rotated);
  }
  return {direction, low, high};
}

FootprintBox longSideFirst(const AlignedBox& aligned) {
  const Eigen::Vector2d& direction = aligned.direction;
  const Eigen::Vector2d across(-direction.y(), direction.x()), middle = 0.5 * (aligned.low + aligned.high);
  FootprintBox box;
  box.center = middle.x() * direction + middle.y() * across;
  box.length_m = aligned.size().x();
  box.width_m = aligned.size().y();
  box.yaw_rad = steady(std::atan2(direction.y(), direction.x()));
  if (box.width_m > box.length_m) {
    std::swap(box.length_m, box.width_m);
    box.yaw_rad += std::numbers::pi / 2;
  }
  while (box.yaw_rad >= std::numbers::pi / 2) box.yaw_rad -= std::numbers::pi;
  while (box.yaw_rad < -std::numbers::pi / 2) box.yaw_rad += std::numbers::pi;
  return box;
}

}  // namespace

std::vector<Eigen::Vector2d> convexHull(std::vector<Eigen::Vector2d> points) {
  if (points.size() >= kMinFiltered) dropInner(points);
  std::sort(points.begin(), points.end(), LessXy());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Eigen::Vector2d> hull;
  appendChain(points.begin(), points.end(), hull);
  appendChain(points.rbegin(), points.rend(), hull);
  return hull;
}

std::vector<Eigen::Vector2d> outerPoints(std::vector<Eigen::Vector2d> points) {
  if (points.size() < kMinFiltered) return points;
  dropInner(points);
  eraseInside(convexHull(points), points);
  return points;
}

FootprintBox smallestBox(const std::vector<Eigen::Vector2d>& hull) {
  if (hull.empty()) return {};
  AlignedBox best = boxAlong(hull, Eigen::Vector2d::UnitX());
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d side = hull[(i + 1) % hull.size()] - hull[i];
    if (side.norm() < 1e-9) continue;
    const AlignedBox box = boxAlong(hull, side.normalized());
    if (box.size().prod() < best.size().prod()) best = box;
  }
  return longSideFirst(best);
}

}  // namespace cluxel
