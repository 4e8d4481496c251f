// SPDX-License-Identifier: Apache-2.0
// What a scan's sensor could see: where it stood, and where its rays end upwards.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "scan/scan.hpp"

namespace cluxel::perception {

/// The upper edge of the field of view of a spinning laser: a cone around the sensor, which may be tilted.
struct UpperEdge {
  /// Elevation = mean + cosine * cos(azimuth) + sine * sin(azimuth) [rad].
  double mean_rad = 0, cosine_rad = 0, sine_rad = 0;
  /// The elevation of the edge in the azimuth of `direction`.
  double elevationAt_rad(const Eigen::Vector3d& direction) const;
};

/// The elevation of a direction [rad].
double elevationOf_rad(const Eigen::Vector3d& direction);

/// What is known of the sensor of a scan.
struct SensorSight {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< where its rays started, in the sensor frame [m]
  std::optional<UpperEdge> upper_edge;               ///< absent when returns show none
};

/// Rays farther apart at their start than this are not taken for one sensor's [m].
inline constexpr double kSameSensor_m = 0.5;

/// The highest returns of 72 sectors of azimuth are compared with a cone. The edge is known when those of at least 24
/// sectors, in at least 6 of 8 directions of the compass, lie within 0.4 degrees of the cone, and few lie above it. A
/// scene without such an edge hardly ever makes one: roofs and crowns differ in elevation.
std::optional<UpperEdge> upperEdgeOf(const scan::ScanPoints& points, const Eigen::Vector3d& origin);

/// Absent when the place of the sensor is unknown: its rays started in several places, or the scan has neither pose nor
/// ray origins nor an upper edge around the origin of its frame. A function of what was measured, and of `has_pose`.
/// Cost: some 10 ns a point.
std::optional<SensorSight> sensorSightOf(const scan::Scan& scan);

}  // namespace cluxel::perception
