// SPDX-License-Identifier: Apache-2.0
// Convex hulls seen from above, and the smallest upright box around them.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace cluxel {

/// The convex hull of `points`, counter-clockwise from the smallest (x, y), without points on its edges; fewer than
/// three points are returned sorted. Cost O(n log n).
std::vector<Eigen::Vector2d> convexHull(std::vector<Eigen::Vector2d> points);

/// Drops points well inside the hull: the hull of the rest is the same to the last bit, also together with any other
/// points. So the hull of many points can be found piece by piece. Cost O(n log n).
std::vector<Eigen::Vector2d> outerPoints(std::vector<Eigen::Vector2d> points);

/// A rectangle around a hull. The rectangle of smallest area has a side along a side of the hull.
struct FootprintBox {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< [m]
  double length_m = 0, width_m = 0;                  ///< length >= width
  double yaw_rad = 0;                                ///< of the length, in [-pi/2, pi/2)
};
FootprintBox smallestBox(const std::vector<Eigen::Vector2d>& hull);

}  // namespace cluxel
