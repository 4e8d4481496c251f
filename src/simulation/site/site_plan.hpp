// SPDX-License-Identifier: Apache-2.0
// The streets, walks and paths of a campus of a given size, and the route of the robot. Deterministic: no random
// numbers.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "simulation/laser/surface_label.hpp"

namespace cluxel::simulation {

/// A street runs along x in the south, with walks on both sides; north of it a rectangle of paths encloses a
/// lawn.
class SitePlan {
 public:
  explicit SitePlan(double size_m);

  static constexpr double kStreetHalf_m = 4;   ///< from the middle of the street to the kerb
  static constexpr double kWalkOuter_m = 6.5;  ///< from the middle of the street to the far edge of the walk
  static constexpr double kKerbWidth_m = 0.15;
  static constexpr double kKerbHeight_m = 0.12;
  static constexpr double kPathHalf_m = 1.3;
  static constexpr double kCrossingHalf_m = 2;
  static constexpr double kMargin_m = 15;  ///< of ground around the campus

  double half_m() const { return half_; }
  double streetY() const { return street_y_; }
  /// The rectangle of paths: centre lines of the west, east, south (the north walk) and north sides.
  double west() const { return west_; }
  double east() const { return east_; }
  double south() const { return south_; }
  double north() const { return north_; }
  const std::array<double, 2>& crossingsX() const { return crossings_; }
  /// The winding path over the lawn: its y at x.
  double windingY(double x) const;

  SurfaceLabel kindAt(double x, double y) const;
  /// Height of the surface relative to the terrain [m]: streets lie below kerbs, paths below the lawn.
  double offsetAt(double x, double y) const;
  /// Whether a disc stays clear of street, walks and paths.
  bool onLawn(const Eigen::Vector2d& center, double radius) const;

  double routeLength_m() const { return 2 * (east_ - west_) + 2 * (north_ - south_); }
  struct RoutePoint {
    Eigen::Vector2d position;
    double heading_rad = 0;
  };
  /// The route goes around the rectangle from the middle of its south side, westwards first.
  RoutePoint routeAt(double distance_m) const;
  double distanceToRoute(const Eigen::Vector2d& point) const;

  /// Lines of the ground grid: about every 0.5 m, and wherever the surface has an edge.
  std::vector<double> gridX() const;
  std::vector<double> gridY() const;

 private:
  double half_, street_y_, west_, east_, south_, north_;
  std::array<double, 2> crossings_;
};

}  // namespace cluxel::simulation
