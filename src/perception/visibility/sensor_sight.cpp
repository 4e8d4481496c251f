// SPDX-License-Identifier: Apache-2.0
// Fits a cone to the highest returns of each sector. Sectors that see no high thing lie below the cone and are left out
// step by step.
#include "perception/visibility/sensor_sight.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/steady_angle.hpp"

namespace cluxel::perception {

namespace {

constexpr std::size_t kEdgeSectors = 72, kSectorsOfOctant = kEdgeSectors / 8;
constexpr double kDegree_rad = std::numbers::pi / 180;
/// Lasers of one sensor start some centimetres apart, which turns the directions of near returns.
constexpr float kMinEdgeRange_m = 4;
constexpr double kBelow_rad = 0.5 * kDegree_rad, kNear_rad = 0.4 * kDegree_rad;
constexpr std::size_t kMinSectors = 24, kMinOctants = 6, kMinFitted = 12;

/// The highest return of a sector of azimuth.
struct Highest {
  float tangent = -1e30F;  ///< of its elevation
  float x = 0, y = 0;      ///< its direction in plan view
};

/// A number from 0 to 71 that follows the azimuth within each octant. Tangents are compared, because calling atan2 for
/// each point would cost more than all the rest.
std::size_t sectorOf(float x, float y) {
  // tan(5 degrees), tan(10 degrees), ... tan(40 degrees)
  constexpr std::array<float, 8> kTangents{0.0874887F, 0.1763270F, 0.2679492F, 0.3639702F,
                                           0.4663077F, 0.5773503F, 0.7002075F, 0.8390996F};
  const float a = std::abs(x), b = std::abs(y);
  const bool is_steep = b > a;
  const float low = is_steep ? a : b, high = is_steep ? b : a;
  std::size_t within = 0;
  for (const float tangent : kTangents) within += low > tangent * high ? 1 : 0;
  const std::size_t octant = (x < 0 ? 4U : 0U) + (y < 0 ? 2U : 0U) + (is_steep ? 1U : 0U);
  return octant * kSectorsOfOctant + within;
}

std::array<Highest, kEdgeSectors> highestReturns(const scan::ScanPoints& points, const Eigen::Vector3f& origin) {
  std::array<Highest, kEdgeSectors> highest;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float x = points.x[i] - origin.x(), y = points.y[i] - origin.y();
    const float range = std::sqrt(x * x + y * y);
    if (!(range >= kMinEdgeRange_m)) continue;
    const float tangent = (points.z[i] - origin.z()) / range;
    Highest& known = highest[sectorOf(x, y)];
    if (tangent > known.tangent) known = {tangent, x / range, y / range};
  }
  return highest;
}

/// The highest return of one sector as a row of the equation for the cone.
struct Sector {
  std::size_t octant = 0;
  Eigen::Vector3d row;  ///< 1, cos(azimuth), sin(azimuth)
  double elevation_rad = 0;
};

std::optional<Eigen::Vector3d> fitted(const std::vector<Sector>& sectors) {
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sums = Eigen::Vector3d::Zero();
  for (const Sector& sector : sectors) {
    products += sector.row * sector.row.transpose();
    sums += sector.elevation_rad * sector.row;
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> solver(products);
  if (!solver.isInvertible()) return std::nullopt;
  return solver.solve(sums);
}

}  // namespace

double UpperEdge::elevationAt_rad(const Eigen::Vector3d& direction) const {
  const double range = direction.head<2>().norm();
  if (range <= 0) return mean_rad;
  return mean_rad + (cosine_rad * direction.x() + sine_rad * direction.y()) / range;
}

double elevationOf_rad(const Eigen::Vector3d& direction) {
  return steady(std::atan2(direction.z(), direction.head<2>().norm()));
}

std::optional<UpperEdge> upperEdgeOf(const scan::ScanPoints& points, const Eigen::Vector3d& origin) {
  const auto highest = highestReturns(points, origin.cast<float>());
  std::vector<Sector> all;
  for (std::size_t i = 0; i < kEdgeSectors; ++i)
    if (highest[i].tangent > -1e30F)
      all.push_back({i / kSectorsOfOctant,
                     {1, static_cast<double>(highest[i].x), static_cast<double>(highest[i].y)},
                     steady(std::atan(static_cast<double>(highest[i].tangent)))});
  std::vector<Sector> kept = all;
  std::optional<Eigen::Vector3d> cone;
  for (std::size_t count = 0; kept.size() != count;) {
    count = kept.size();
    if (count < kMinFitted) return std::nullopt;
    cone = fitted(kept);
    if (!cone) return std::nullopt;
    std::erase_if(kept,
                  [&](const Sector& sector) { return sector.elevation_rad < cone->dot(sector.row) - kBelow_rad; });
  }
  std::erase_if(kept, [&](const Sector& sector) { return sector.elevation_rad > cone->dot(sector.row) + kBelow_rad; });
  if (kept.size() < kMinFitted) return std::nullopt;
  cone = fitted(kept);
  if (!cone) return std::nullopt;
  std::size_t near = 0, above = 0;
  std::bitset<8> octants;
  for (const Sector& sector : all) {
    const double difference = sector.elevation_rad - cone->dot(sector.row);
    if (difference > kNear_rad) ++above;
    if (std::abs(difference) > kNear_rad) continue;
    ++near;
    octants.set(sector.octant);
  }
  if (near < kMinSectors || octants.count() < kMinOctants || 4 * above > near) return std::nullopt;
  return UpperEdge{steady((*cone)[0]), steady((*cone)[1]), steady((*cone)[2])};
}

std::optional<SensorSight> sensorSightOf(const scan::Scan& scan) {
  SensorSight sight;
  if (!scan.points.origin.empty()) {
    const Eigen::Vector3f& first = scan.points.origin.front();
    const bool is_one = std::all_of(scan.points.origin.begin(), scan.points.origin.end(), [&](const auto& origin) {
      return static_cast<double>((origin - first).norm()) <= kSameSensor_m;
    });
    if (!is_one) return std::nullopt;
    sight.origin = first.cast<double>();
  }
  sight.upper_edge = upperEdgeOf(scan.points, sight.origin);
  if (!scan.has_pose && scan.points.origin.empty() && !sight.upper_edge) return std::nullopt;
  return sight;
}

}  // namespace cluxel::perception
