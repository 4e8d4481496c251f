// SPDX-License-Identifier: Apache-2.0
// Whether scans look at places where something may stand, against all rays one by one.
#include "perception/visibility/standing_place.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "perception/rays_of_scan.hpp"

namespace cluxel::perception {
namespace {

/// Where a ray goes on level ground with walls of 3 m before and 6 m after x = 10, up to `range_m`.
Eigen::Vector3d endOf(const Eigen::Vector3d& start, const Eigen::Vector3d& way, double range_m) {
  constexpr double kWall_m = 10, kTop_m = 3;
  if (way.z() < 0) range_m = std::min(range_m, -start.z() / way.z());
  if (way.x() > 0) {
    const double to_wall = (kWall_m - start.x()) / way.x();
    const Eigen::Vector3d there = start + to_wall * way;
    if (to_wall > 0 && there.z() < kTop_m && there.y() > -4) range_m = std::min(range_m, to_wall);
  }
  return start + range_m * way;
}

/// From all rays, without an index. Rays that start within `view_m` count, those of each of the starts by themselves.
bool isLookedAt(const std::vector<Ray>& rays, const std::vector<Eigen::Vector3d>& starts, const StandingPlace& place,
                double view_m) {
  constexpr double near_m = 0.15, measured_m = 0.5, hit_m = 0.25, behind_m = 0.40, nearest_m = 0.3;
  std::vector<double> heights;
  const double top_m = std::max(place.height_m, 0.3);
  for (int i = 0; i == 0 || i * 0.3 <= top_m + 1e-9; ++i) heights.push_back(0.3 * i);
  if (top_m - heights.back() > 0.15) heights.push_back(top_m);
  for (const Eigen::Vector3d& start : starts) {
    if ((start - place.foot).head<2>().norm() > view_m) continue;
    int passed = 0, stopped = 0;
    for (const double height : heights) {
      const Eigen::Vector3d point = place.foot + Eigen::Vector3d(0, 0, height);
      for (const Ray& ray : rays) {
        if (ray.start != start) continue;
        const Eigen::Vector3d way = (ray.end - ray.start).normalized(), to_point = point - ray.start;
        const double range_m = (ray.end - ray.start).norm(), along_m = to_point.dot(way);
        const double aside_m = (to_point - along_m * way).norm();
        if (along_m <= 0 || aside_m > measured_m || to_point.norm() < nearest_m) continue;
        if (std::abs(range_m - along_m) <= hit_m) return true;
        if (height > 0 && aside_m <= near_m) ++(range_m >= along_m + behind_m ? passed : stopped);
      }
    }
    if (passed >= 3 && stopped <= passed) return true;
  }
  return false;
}

TEST(StandingPlace, IsLookedAtAsAllRaysOneByOneTell) {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> around(-3.1415, 3.1415), up(-0.7, 0.03), x(-20, 20), height(0, 4);
  std::vector<Ray> rays;
  const std::vector<Eigen::Vector3d> starts{{0, 0, 1.8}, {-6, 5, 1.5}};
  for (const Eigen::Vector3d& start : starts)
    for (int i = 0; i < 12'000; ++i) {
      const double elevation = up(random), azimuth = around(random);
      const Eigen::Vector3d way(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                std::sin(elevation));
      rays.push_back({start, endOf(start, way, 40)});
    }
  const ScanRays scan(scanOfRays(rays));
  std::array<int, 2> found{};
  for (int i = 0; i < 600; ++i) {
    const StandingPlace place{{x(random), x(random), 0}, height(random)};
    const double view_m = 5 + i % 20;
    const bool expected = isLookedAt(rays, starts, place, view_m);
    ASSERT_EQ(looksAt(scan, place, view_m), expected) << place.foot.transpose() << ", " << place.height_m;
    ++found[expected ? 1 : 0];
  }
  EXPECT_GT(found[0], 100);
  EXPECT_GT(found[1], 100);
}

/// Rays to a wall 12 m away, in steps of a decimetre, and a lower one that hides what is below `hidden_m`.
ScanRays overAWall(double hidden_m) {
  const Eigen::Vector3d start(0, 0, 1.5);
  std::vector<Ray> rays;
  for (double y = -2; y <= 2; y += 0.1)
    for (double z = 0.05; z <= 4; z += 0.1) {
      const Eigen::Vector3d way = Eigen::Vector3d(12, y, z) - start;
      const double at_wall = 4.0 / 12.0;
      rays.push_back({start, start + ((start + at_wall * way).z() < hidden_m ? at_wall : 1.0) * way});
    }
  return ScanRays(scanOfRays(rays));
}

TEST(StandingPlace, IsSeenWhenMoreOfTheThingIsSeenThanHidden) {
  const StandingPlace low{{8, 0, 0}, 1}, middle{{8, 0, 0}, 1.6}, high{{8, 0, 0}, 3.5};
  EXPECT_TRUE(looksAt(overAWall(0), low, 25));
  const ScanRays hidden = overAWall(1.4);  // 1.3 m at the place
  EXPECT_FALSE(looksAt(hidden, low, 25)) << "nothing of it is seen";
  EXPECT_FALSE(looksAt(hidden, middle, 25)) << "only its top is";
  EXPECT_TRUE(looksAt(hidden, high, 25)) << "its upper part is";
  EXPECT_FALSE(looksAt(hidden, high, 7)) << "too far away";
}

/// A scan along a street has both: rays that a wall stops, and rays that start beyond it.
TEST(StandingPlace, IsSeenFromWhereNothingHidesIt) {
  std::vector<Ray> rays;
  const Eigen::Vector3d hidden(0, 0, 1.5), free(8, 10, 1.5);
  for (double y = -2; y <= 2; y += 0.05)
    for (double z = 0.4; z <= 3; z += 0.1) {
      const Eigen::Vector3d way = Eigen::Vector3d(12, y, z) - hidden;
      rays.push_back({hidden, hidden + way / 3});
    }
  const StandingPlace place{{8, 0, 0}, 1.5};
  EXPECT_FALSE(looksAt(ScanRays(scanOfRays(rays)), place, 25));
  for (double x = 7.5; x <= 8.5; x += 0.1)
    for (double z = 0.4; z <= 2; z += 0.3) rays.push_back({free, Eigen::Vector3d(x, -4, z)});
  EXPECT_TRUE(looksAt(ScanRays(scanOfRays(rays)), place, 25));
}

TEST(StandingPlace, BehindAWallIsNotSeen) {
  const Eigen::Vector3d start(0, 0, 1.5);
  std::vector<Ray> rays;
  for (double y = -2; y <= 2; y += 0.05)
    for (double z = 0.05; z <= 3; z += 0.1) rays.push_back({start, Eigen::Vector3d(8, y, z)});
  const ScanRays scan(scanOfRays(rays));
  EXPECT_FALSE(looksAt(scan, {{8.35, 0, 0}, 1}, 25));
  EXPECT_TRUE(looksAt(scan, {{8.1, 0, 0}, 1}, 25)) << "an entry is no more exact";
}

TEST(StandingPlace, OfHugeOrNoHeightHasFewPoints) {
  EXPECT_EQ(pointsOf({{0, 0, 5}, 1e300}).size(), 101U);
  EXPECT_EQ(pointsOf({{0, 0, 5}, -1}).size(), 2U);
  const std::vector<Eigen::Vector3d> points = pointsOf({{1, 2, 5}, 0.9});
  ASSERT_EQ(points.size(), 4U);
  EXPECT_NEAR(points.back().z(), 5.9, 1e-9);
  EXPECT_NEAR(pointsOf({{1, 2, 5}, 1.19}).back().z(), 6.19, 1e-9) << "the top, 0.29 m above the last step";
}

}  // namespace
}  // namespace cluxel::perception
