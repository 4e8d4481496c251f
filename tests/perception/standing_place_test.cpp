// SPDX-License-Identifier: Apache-2.0
// Whether scans look at places where something may stand, against all rays one by one.
#include "perception/visibility/standing_place.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>
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

bool looksAt(const ScanRays& rays, const StandingPlace& place, double view_m) {
  return LookingRays(rays, view_m, {}).lookAt(place);
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

/// As a scanner gives them that is carried along: each ray starts elsewhere, some of them twice.
std::vector<Ray> raysFromEverywhere(std::size_t count, double size_m, std::mt19937& random) {
  std::uniform_real_distribution<double> place(-size_m / 2, size_m / 2), height(0.5, 2), around(-3.1415, 3.1415);
  std::normal_distribution<double> up(0, 0.2);
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const auto rounded = [](double at) { return std::round(at * 4) / 4; };  // none is taken for a neighbour's start
    const Eigen::Vector3d start(rounded(place(random)), rounded(place(random)), rounded(height(random)));
    const double azimuth = around(random), elevation = up(random);
    const Eigen::Vector3d way(std::cos(azimuth), std::sin(azimuth), std::tan(elevation));
    rays.push_back({start, endOf(start, way, std::abs(20 * up(random)) + 0.4)});
    if (rays.size() % 9 == 0) rays.push_back({start, endOf(start, -way, 30)});
  }
  return rays;
}

/// From all bundles in view, without an index; none has so many rays that missing ones tell.
bool isLookedAtByAny(const ScanRays& scan, const StandingPlace& place, double view_m) {
  constexpr double square_m = 2;
  RayParams measured;
  measured.near_m = 0.5;
  std::map<std::pair<double, double>, std::array<std::uint64_t, 2>> passed_stopped;
  for (const RayBundle& bundle : scan.bundles()) {
    const Eigen::Vector3d start = bundle.origin();
    if ((start - place.foot).head<2>().norm() > view_m) continue;
    auto& [passed, stopped] = passed_stopped[{std::floor(start.x() / square_m), std::floor(start.y() / square_m)}];
    for (const Eigen::Vector3d& point : pointsOf(place)) {
      if (bundle.raysNear(point, measured).counts.ended > 0) return true;
      if (point == place.foot) continue;
      const RaysNear near = bundle.raysNear(point, {});
      passed += near.counts.passed, stopped += near.others;
    }
  }
  return std::any_of(passed_stopped.begin(), passed_stopped.end(), [](const auto& of_square) {
    return of_square.second[0] >= 3 && of_square.second[1] <= of_square.second[0];
  });
}

TEST(StandingPlace, IsLookedAtByRaysThatStartEverywhereAsAllOfThemTell) {
  std::mt19937 random(5);
  std::vector<Ray> rays = raysFromEverywhere(15'000, 40, random);
  const ScanRays scan(scanOfRays(rays));
  // In the frame of another origin, the squares in which rays start lie between its own.
  const Eigen::Vector3d shift(5.25, -2.75, 0);
  for (Ray& ray : rays) ray.start += shift, ray.end += shift;
  const ScanRays shifted_scan(scanOfRays(rays));
  std::uniform_real_distribution<double> at(-22, 22), height(0, 3);
  std::array<int, 2> found{};
  for (const double view_m : {0.3, 2.0, 7.0, 25.0, 1e9}) {
    const LookingRays looking(scan, view_m, {}), shifted(shifted_scan, view_m, TileGrid::at(shift));
    for (int i = 0; i < 300; ++i) {
      const StandingPlace place{{at(random), at(random), 2 * height(random)}, height(random)};
      const bool expected = isLookedAtByAny(scan, place, view_m);
      ASSERT_EQ(looking.lookAt(place), expected) << place.foot.transpose() << ", " << place.height_m << ", " << view_m;
      ASSERT_EQ(shifted.lookAt({place.foot + shift, place.height_m}), expected) << place.foot.transpose();
      ++found[expected ? 1 : 0];
    }
  }
  EXPECT_GT(found[0], 100);
  EXPECT_GT(found[1], 100);
}

TEST(StandingPlace, AsksFewOfTheRaysThatStartEverywhere) {
  std::mt19937 random(6);
  const ScanRays scan(scanOfRays(raysFromEverywhere(20'000, 200, random)));
  const LookingRays looking(scan, 25, {});
  std::size_t asked = 0, in_view = 0;
  std::uniform_real_distribution<double> at(-100, 100);
  for (int i = 0; i < 100; ++i) {
    const StandingPlace place{{at(random), at(random), 0}, 1};
    asked += looking.bundlesNear(place).size();
    in_view += static_cast<std::size_t>(
        std::count_if(scan.bundles().begin(), scan.bundles().end(),
                      [&](const RayBundle& bundle) { return (bundle.origin() - place.foot).head<2>().norm() <= 25; }));
  }
  EXPECT_GT(asked, 0U);
  EXPECT_LT(5 * asked, in_view);
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
