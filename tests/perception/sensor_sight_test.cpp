// SPDX-License-Identifier: Apache-2.0
// The upper edge of a scan's field of view, found from returns.
#include "perception/visibility/sensor_sight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace cluxel::testing {

using namespace scan;
using namespace perception;
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180;

/// A spinning laser with beams every half degree up to the edge, tilted by `tilt` degrees toward x. Within the azimuths
/// `walls` there is a wall 30 m away; elsewhere the ground, 2 m below the sensor, and the sky.
Scan spinningScan(double edge_deg, double tilt_deg, double walls_deg) {
  Scan scan;
  for (double azimuth = 0; azimuth < 360; azimuth += 0.5)
    for (double elevation = edge_deg - 26; elevation <= edge_deg + 1e-9; elevation += 0.5) {
      const double a = azimuth * kDegree_rad;
      const double e = (elevation + tilt_deg * std::cos(a)) * kDegree_rad;
      const bool is_wall = azimuth < walls_deg;
      const double to_ground = e < 0 ? 2 / std::tan(-e) : 1e9;
      const double range = is_wall ? std::min(30.0, to_ground) : to_ground;
      if (range > 80) continue;
      scan.points.x.push_back(static_cast<float>(range * std::cos(a)));
      scan.points.y.push_back(static_cast<float>(range * std::sin(a)));
      scan.points.z.push_back(static_cast<float>(range * std::tan(e)));
    }
  return scan;
}

TEST(UpperEdge, IsFoundInAllDirectionsOfALevelSensor) {
  const auto edge = upperEdgeOf(spinningScan(2, 0, 360).points, {0, 0, 0});
  ASSERT_TRUE(edge);
  for (const Eigen::Vector3d& direction : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-3, 4, 1)})
    EXPECT_NEAR(edge->elevationAt_rad(direction), 2 * kDegree_rad, 0.02 * kDegree_rad);
}

TEST(UpperEdge, IsFoundWhereAThirdOfTheDirectionsShowOnlySky) {
  const auto edge = upperEdgeOf(spinningScan(2, 0, 280).points, {0, 0, 0});
  ASSERT_TRUE(edge);
  EXPECT_NEAR(edge->elevationAt_rad({0, -1, 0}), 2 * kDegree_rad, 0.1 * kDegree_rad);
}

TEST(UpperEdge, FollowsATiltedSensor) {
  const auto edge = upperEdgeOf(spinningScan(3, 1.5, 360).points, {0, 0, 0});
  ASSERT_TRUE(edge);
  EXPECT_NEAR(edge->elevationAt_rad({1, 0, 0}), 4.5 * kDegree_rad, 0.05 * kDegree_rad);
  EXPECT_NEAR(edge->elevationAt_rad({-1, 0, 0}), 1.5 * kDegree_rad, 0.05 * kDegree_rad);
}

TEST(UpperEdge, IsUnknownWhereThingsAndNotTheSensorEndTheView) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-40, 40), height(0, 15);
  ScanPoints points;
  for (int i = 0; i < 20000; ++i) {
    points.x.push_back(place(random)), points.y.push_back(place(random)), points.z.push_back(height(random));
  }
  EXPECT_FALSE(upperEdgeOf(points, {0, 0, 2}));
  EXPECT_FALSE(upperEdgeOf({}, {0, 0, 0}));
}

TEST(UpperEdge, DoesNotDependOnTheOrderOfPoints) {
  const Scan scan = spinningScan(2, 0.7, 300);
  Scan reversed = scan;
  for (auto* values : {&reversed.points.x, &reversed.points.y, &reversed.points.z})
    std::reverse(values->begin(), values->end());
  const auto a = upperEdgeOf(scan.points, {0, 0, 0}), b = upperEdgeOf(reversed.points, {0, 0, 0});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->mean_rad, b->mean_rad);
  EXPECT_EQ(a->cosine_rad, b->cosine_rad);
  EXPECT_EQ(a->sine_rad, b->sine_rad);
}

TEST(SensorSight, IsUnknownWithoutPoseOriginsAndEdge) {
  Scan scan;
  scan.points.x = {1, 2, 30}, scan.points.y = {0, 5, 2}, scan.points.z = {1, 1, 8};
  EXPECT_FALSE(sensorSightOf(scan));
  scan.has_pose = true;
  ASSERT_TRUE(sensorSightOf(scan));
  EXPECT_FALSE(sensorSightOf(scan)->upper_edge);
}

TEST(SensorSight, TakesTheOriginOfTheFrameForTheSensorWhenTheEdgeShowsIt) {
  const auto sight = sensorSightOf(spinningScan(2, 0, 360));
  ASSERT_TRUE(sight);
  EXPECT_TRUE(sight->upper_edge);
  EXPECT_EQ(sight->origin, Eigen::Vector3d(0, 0, 0));
}

TEST(SensorSight, IsUnknownWhenRaysStartInSeveralPlaces) {
  Scan scan = spinningScan(2, 0, 360);
  scan.points.origin.assign(scan.points.size(), Eigen::Vector3f(0, 0, 0));
  EXPECT_TRUE(sensorSightOf(scan));
  scan.points.origin.back() = {3, 0, 0};
  EXPECT_FALSE(sensorSightOf(scan));
}

}  // namespace
}  // namespace cluxel::testing
