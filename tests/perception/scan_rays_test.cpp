// SPDX-License-Identifier: Apache-2.0
// Verdicts of rays about places, against all rays one by one.
#include "perception/visibility/scan_rays.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "perception/rays_of_scan.hpp"

namespace cluxel::perception {
namespace {

/// Rays that start at one place; `ends` are relative to it.
ScanRays raysFrom(const Eigen::Vector3d& origin, const std::vector<Eigen::Vector3f>& ends) {
  scan::Scan scan;
  scan.has_pose = true;
  scan.T_map_sensor = Eigen::Translation3d(origin) * Eigen::Isometry3d::Identity();
  for (const Eigen::Vector3f& end : ends)
    scan.points.x.push_back(end.x()), scan.points.y.push_back(end.y()), scan.points.z.push_back(end.z());
  return ScanRays(scan);
}

/// The verdict from all rays, without an index.
PlaceVerdict verdictOfAll(const std::vector<Eigen::Vector3f>& ends, const Eigen::Vector3d& origin,
                          const Eigen::Vector3d& place_map, const RayParams& params) {
  const Eigen::Vector3d place = place_map - origin;
  int hitting = 0, passing = 0, near = 0;
  for (const Eigen::Vector3f& each : ends) {
    const Eigen::Vector3d end = each.cast<double>();
    const double range = end.norm(), along = place.dot(end) / range;
    if (along <= 0 || place.squaredNorm() - along * along > params.near_m * params.near_m) continue;
    ++near;
    hitting += std::abs(range - along) <= params.hit_m ? 1 : 0;
    passing += range >= along + params.behind_m ? 1 : 0;
  }
  if (hitting + passing == 0) return {};
  const bool is_sparse = hitting + passing < params.min_rays;
  if (hitting > 0) return {RayVerdict::Hit, is_sparse};
  if (near - passing > passing) return {};
  return {is_sparse ? RayVerdict::FewPassed : RayVerdict::SeenThrough, is_sparse};
}

Eigen::Vector3d randomDirection(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
}

TEST(ScanRays, AgreesWithAllRaysOneByOne) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> range(1, 12), unit(-1, 1);
  const Eigen::Vector3d origin(100, -50, 3);
  std::vector<Eigen::Vector3f> ends;
  for (int i = 0; i < 30'000; ++i) ends.push_back((range(random) * randomDirection(random)).cast<float>());
  // Poles of the grid of directions, where columns are narrow, and the seam of the azimuth.
  for (const Eigen::Vector3d& special :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(-1, 0, 0)})
    for (int i = 0; i < 2'000; ++i)
      ends.push_back((range(random) * (special + 0.05 * randomDirection(random)).normalized()).cast<float>());
  const ScanRays rays = raysFrom(origin, ends);
  std::array<int, 4> seen{};
  for (int i = 0; i < 3'000; ++i) {
    Eigen::Vector3d direction = randomDirection(random);
    if (i % 4 == 1)
      direction = Eigen::Vector3d(0.03 * unit(random), 0.03 * unit(random), i % 8 == 1 ? 1 : -1).normalized();
    if (i % 4 == 2) direction = Eigen::Vector3d(-1, 0.02 * unit(random), 0.02 * unit(random)).normalized();
    const Eigen::Vector3d place = origin + range(random) * direction;
    const PlaceVerdict expected = verdictOfAll(ends, origin, place, {}), got = rays.verdictAt(place, {});
    ASSERT_EQ(got.verdict, expected.verdict) << i;
    ASSERT_EQ(got.is_sparse, expected.is_sparse) << i;
    ++seen[static_cast<std::size_t>(got.verdict)];
  }
  for (const int count : seen) EXPECT_GT(count, 20);
}

/// Cells of direction are found by angles that are nearly right: rays at the edges of cells must not be lost.
TEST(DirectionIndex, FindsEachRayInItsOwnDirection) {
  constexpr double kHalfDegree = std::numbers::pi / 360;
  std::mt19937 random(4);
  std::normal_distribution<double> off(0, 2e-6);
  std::uniform_int_distribution<int> column(-360, 360), row(-178, 178);
  std::vector<Eigen::Vector3f> ends;
  for (int i = 0; i < 50'000; ++i) {
    const double azimuth = kHalfDegree * column(random) + off(random);
    const double elevation = kHalfDegree * row(random) + off(random);
    const Eigen::Vector3d direction(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                                    std::sin(elevation));
    ends.push_back((10 * direction).cast<float>());
  }
  const DirectionIndex index(ends);
  for (const Eigen::Vector3f& end : ends) {
    int near = 0;
    index.forEachNear(end.cast<double>(), 1e-6, [&](const auto&...) { ++near; });
    ASSERT_GT(near, 0) << end.transpose();
  }
}

/// A wall 10 m ahead, as a sensor at `origin` sees it, with rays every `step_m` on the wall.
std::vector<Eigen::Vector3f> wallAhead(double step_m) {
  std::vector<Eigen::Vector3f> ends;
  for (double y = -1; y <= 1; y += step_m)
    for (double z = -1; z <= 1; z += step_m) ends.emplace_back(10, y, z);
  return ends;
}

TEST(ScanRays, TellsWhatIsHitHiddenAndSeenThrough) {
  const ScanRays rays = raysFrom(Eigen::Vector3d::Zero(), wallAhead(0.05));
  EXPECT_EQ(rays.verdictAt({10, 0, 0}, {}).verdict, RayVerdict::Hit);
  EXPECT_EQ(rays.verdictAt({5, 0, 0}, {}).verdict, RayVerdict::SeenThrough);
  EXPECT_EQ(rays.verdictAt({15, 0, 0}, {}).verdict, RayVerdict::NotCovered) << "hidden by the wall";
  EXPECT_EQ(rays.verdictAt({5, 4, 0}, {}).verdict, RayVerdict::NotCovered) << "no ray goes there";
  EXPECT_EQ(rays.verdictAt({-5, 0, 0}, {}).verdict, RayVerdict::NotCovered) << "behind the sensor";
  EXPECT_EQ(rays.verdictAt({9.7, 0, 0}, {}).verdict, RayVerdict::NotCovered) << "too near the wall to tell";
}

TEST(ScanRays, ConcludesNothingAtTheEdgeOfWhatHidesAPlace) {
  std::vector<Eigen::Vector3f> ends = wallAhead(0.05);
  const auto endAtBoard = [&](double edge_y) {  // a board 2 m ahead: rays to the left of an edge on the wall
    std::vector<Eigen::Vector3f> shortened = ends;
    for (Eigen::Vector3f& end : shortened)
      if (end.y() > edge_y) end *= 0.2F;
    return raysFrom(Eigen::Vector3d::Zero(), shortened);
  };
  const Eigen::Vector3d place(5, 0, 0);
  EXPECT_EQ(endAtBoard(0.12).verdictAt(place, {}).verdict, RayVerdict::SeenThrough);
  EXPECT_EQ(endAtBoard(-0.12).verdictAt(place, {}).verdict, RayVerdict::NotCovered);
  EXPECT_EQ(endAtBoard(-0.4).verdictAt(place, {}).verdict, RayVerdict::NotCovered);
}

TEST(ScanRays, DoesNotConcludeFromFewRays) {
  const ScanRays rays = raysFrom(Eigen::Vector3d::Zero(), wallAhead(0.5));
  const PlaceVerdict place = rays.verdictAt({5, 0, 0}, {});
  EXPECT_EQ(place.verdict, RayVerdict::FewPassed);
  EXPECT_TRUE(place.is_sparse);
}

/// What a sensor 2 m above the ground sees with rays every `step` in both angles [rad]: the ground to 60 m, a wall 10 m
/// behind it, 8 m high above the sensor, and before it nothing but the sky. `isKept` drops rays by their ends, and
/// `isLost` by their directions.
struct OpenPlace {
  double pan_step = 0.006, tilt_step = 0.006;
  std::function<bool(const Eigen::Vector3d&)> isKept = [](const Eigen::Vector3d&) { return true; };
  std::function<bool(const Eigen::Vector3d&)> isLost = [](const Eigen::Vector3d&) { return false; };

  ScanRays seen() const {
    std::vector<Eigen::Vector3f> ends;
    for (double tilt = -0.8; tilt < 0.9; tilt += tilt_step)
      for (double pan = -std::numbers::pi; pan < std::numbers::pi; pan += pan_step) {
        const Eigen::Vector3d way(std::cos(tilt) * std::cos(pan), std::cos(tilt) * std::sin(pan), std::sin(tilt));
        double range_m = way.z() < 0 ? 2 / -way.z() : 1e9;
        if (way.x() < 0 && 10 / -way.x() * way.z() < 8) range_m = std::min(range_m, 10 / -way.x());
        if (range_m > 60 || isLost(way) || !isKept(range_m * way)) continue;
        ends.push_back((range_m * way).cast<float>());
      }
    return raysFrom(Eigen::Vector3d::Zero(), ends);
  }
};

/// Where the head of a lamp stood.
const Eigen::Vector3d kHead(10, 0.3, 3);

TEST(ScanRays, SeesThroughPlacesBeforeTheSky) {
  const ScanRays rays = OpenPlace().seen();
  EXPECT_EQ(rays.verdictAt(kHead, {}).verdict, RayVerdict::SeenThrough);
  EXPECT_EQ(rays.verdictAt({10, 0.3, 7}, {}).verdict, RayVerdict::SeenThrough);
  EXPECT_EQ(rays.verdictAt({10, 0.3, 9.5}, {}).verdict, RayVerdict::NotCovered) << "higher than all returns";
}

TEST(ScanRays, ConcludesNothingFromMissingReturnsOfScansThatWereThinnedOrCut) {
  const auto verdictOf = [](const OpenPlace& place) { return place.seen().verdictAt(kHead, {}).verdict; };
  std::mt19937 random(5);
  EXPECT_EQ(verdictOf({.isKept = [&](const auto&) { return random() % 8 == 0; }}), RayVerdict::NotCovered);
  EXPECT_EQ(verdictOf({.isKept = [](const auto& end) { return end.z() < 2; }}), RayVerdict::NotCovered) << "by height";
  EXPECT_EQ(verdictOf({.isKept = [](const auto& end) { return end.norm() < 9; }}), RayVerdict::NotCovered)
      << "by range";
  EXPECT_EQ(verdictOf({.isKept = [](const auto& end) { return end.x() < 0; }}), RayVerdict::NotCovered) << "by azimuth";
  EXPECT_EQ(verdictOf({.tilt_step = 0.04}), RayVerdict::NotCovered) << "rings far apart";
  EXPECT_EQ(verdictOf({.pan_step = 0.04}), RayVerdict::NotCovered) << "columns far apart";
}

TEST(ScanRays, ConcludesNothingBehindWhatSwallowsRays) {
  // A black van 5 m ahead, 4 m wide and up to 2.2 m above the sensor.
  const auto meetsVan = [](const Eigen::Vector3d& way) {
    return way.x() > 0 && std::abs(5 * way.y() / way.x()) < 2 && 5 * way.z() / way.x() < 2.2;
  };
  EXPECT_EQ(OpenPlace{.isLost = meetsVan}.seen().verdictAt(kHead, {}).verdict, RayVerdict::NotCovered);
  // A wet road returns nothing beyond 6 m.
  const auto slips = [](const Eigen::Vector3d& way) { return way.x() > 0 && way.z() < 0 && way.z() > -2.0 / 6; };
  EXPECT_EQ(OpenPlace{.isLost = slips}.seen().verdictAt(kHead, {}).verdict, RayVerdict::NotCovered);
  // A window in a wall tells nothing of what may stand behind it, nor does a place below the sensor.
  const auto window = [](const Eigen::Vector3d& way) { return way.x() < -0.9 && std::abs(way.z()) < 0.2; };
  EXPECT_EQ(OpenPlace{.isLost = window}.seen().verdictAt({-12, 0, 0.5}, {}).verdict, RayVerdict::NotCovered);
  const auto puddle = [](const Eigen::Vector3d& way) { return way.x() > 0 && way.z() < -0.05 && way.z() > -0.5; };
  EXPECT_EQ(OpenPlace{.isLost = puddle}.seen().verdictAt({10, 0, -1}, {}).verdict, RayVerdict::NotCovered);
}

TEST(ScanRays, TakesRaysWithOwnOriginsTogetherWhereTheyStartTogether) {
  scan::Scan scan;
  scan.T_map_sensor = Eigen::Translation3d(7, 0, 0) * Eigen::Isometry3d::Identity();
  for (int i = 0; i < 40; ++i) {
    const auto at = static_cast<float>(i);
    scan.points.x.push_back(at), scan.points.y.push_back(5), scan.points.z.push_back(0);
    scan.points.origin.emplace_back(i < 20 ? 0.001F * at : 3, 0, 0);
  }
  const ScanRays rays(scan);
  ASSERT_EQ(rays.bundles().size(), 2U);
  EXPECT_TRUE(rays.bundles()[0].origin().isApprox(Eigen::Vector3d(7, 0, 0)));
  EXPECT_TRUE(rays.bundles()[1].origin().isApprox(Eigen::Vector3d(10, 0, 0)));
  scan.points.origin.clear();
  EXPECT_TRUE(ScanRays(scan).empty()) << "a scan without pose has no origin";
}

TEST(ScanRays, OfALaserThatMovesTellTheSameInAnyOrder) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Ray> rays;
  for (int i = 0; i < 24'000; ++i) {
    const Eigen::Vector3d start(0.2 * (i % 12), 0, 0);  // two lasers or more take turns
    rays.push_back({start, start + (2 + 8 * unit(random)) * randomDirection(random)});
  }
  const ScanRays taking_turns(scanOfRays(rays));
  std::vector<Ray> in_turn = rays;
  std::stable_sort(in_turn.begin(), in_turn.end(),
                   [](const Ray& a, const Ray& b) { return a.start.x() > b.start.x(); });
  const ScanRays one_after_the_other(scanOfRays(in_turn));
  ASSERT_EQ(taking_turns.bundles().size(), 12U);
  std::array<int, 4> seen{};
  for (int i = 0; i < 2'000; ++i) {
    const Eigen::Vector3d place = (0.5 + 8 * unit(random)) * randomDirection(random);
    RayCounts expected;  // of all rays one by one
    for (const Ray& ray : rays) {
      const Eigen::Vector3d way = ray.end - ray.start, to_place = place - ray.start;
      const double range = way.norm(), along = to_place.dot(way) / range;
      if (to_place.norm() < 0.3 || along <= 0 || to_place.squaredNorm() - along * along > 0.15 * 0.15) continue;
      expected.ended += std::abs(range - along) <= 0.25 ? 1 : 0;
      expected.passed += range >= along + 0.4 ? 1 : 0;
    }
    const RayCounts counts = taking_turns.countsAt(place, {});
    ASSERT_NEAR(static_cast<double>(counts.ended), static_cast<double>(expected.ended), 1) << "rounding at the limits";
    ASSERT_NEAR(static_cast<double>(counts.passed), static_cast<double>(expected.passed), 1);
    const PlaceVerdict verdict = taking_turns.verdictAt(place, {});
    ASSERT_EQ(verdict.verdict, one_after_the_other.verdictAt(place, {}).verdict);
    ++seen[static_cast<std::size_t>(verdict.verdict)];
  }
  for (const int count : seen) EXPECT_GT(count, 20);
}

TEST(ScanRays, OfALaserThatMovesInShortStepsStartAtTheSamePlacesInAnyOrder) {
  std::mt19937 random(7);
  std::vector<Ray> rays;
  for (int i = 0; i < 4'000; ++i) {
    const Eigen::Vector3d start(0.009 * (i / 100), 0, 0);
    rays.push_back({start, start + (2 + 0.001 * i) * randomDirection(random)});
  }
  const ScanRays forwards(scanOfRays(rays));
  ASSERT_EQ(forwards.bundles().size(), 7U);
  for (int round = 0; round < 3; ++round) {
    std::shuffle(rays.begin(), rays.end(), random);
    const ScanRays shuffled(scanOfRays(rays));
    ASSERT_EQ(shuffled.bundles().size(), forwards.bundles().size());
    for (std::size_t i = 0; i < shuffled.bundles().size(); ++i) {
      ASSERT_EQ(shuffled.bundles()[i].origin(), forwards.bundles()[i].origin());
      ASSERT_EQ(shuffled.bundles()[i].maxRange_m(), forwards.bundles()[i].maxRange_m());
    }
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector3d place = 3 * randomDirection(random);
      ASSERT_EQ(shuffled.verdictAt(place, {}).verdict, forwards.verdictAt(place, {}).verdict);
    }
  }
}

TEST(ScanRays, OfOneScanTellTogetherWhereverTheyStart) {
  std::vector<Ray> rays;
  for (int i = 0; i < 3; ++i) rays.push_back({{0.2 * i, 0, 0}, {10, 0, 0}});
  EXPECT_EQ(ScanRays(scanOfRays(rays)).verdictAt({5, 0, 0}, {}).verdict, RayVerdict::SeenThrough);
  rays.pop_back();
  EXPECT_EQ(ScanRays(scanOfRays(rays)).verdictAt({5, 0, 0}, {}).verdict, RayVerdict::FewPassed);
}

/// Rays from the origin to a plane x = 5 m with bars 4 cm wide every 16 cm, and to a wall at x = 9 m where there is
/// none.
ScanRays raysAtBars(bool is_solid) {
  std::vector<Eigen::Vector3f> ends;
  for (int row = -20; row <= 20; ++row)
    for (int column = -200; column <= 200; ++column) {
      const double y = column * 0.02, z = row * 0.05;  // at x = 5
      const bool is_bar = is_solid || ((column % 8) + 8) % 8 < 2;
      const double x = is_bar ? 5 : 9;
      ends.emplace_back(static_cast<float>(x), static_cast<float>(y * x / 5), static_cast<float>(z * x / 5));
    }
  return raysFrom(Eigen::Vector3d::Zero(), ends);
}

RayCounts countsOn(const ScanRays& rays) {
  RayCounts sum;
  for (int i = -15; i <= 15; ++i) {
    const RayCounts counts = rays.countsAt({5, i * 0.2, 0.3}, {.near_m = 0.10, .behind_m = 0.50});
    sum.ended += counts.ended, sum.passed += counts.passed;
  }
  return sum;
}

TEST(ScanRays, CountsRaysThatGoThroughAFence) {
  const RayCounts counts = countsOn(raysAtBars(false));
  EXPECT_NEAR(static_cast<double>(counts.passed) / static_cast<double>(counts.passed + counts.ended), 0.75, 0.05);
}

TEST(ScanRays, CountsNoneThroughAWall) {
  const RayCounts counts = countsOn(raysAtBars(true));
  EXPECT_GT(counts.ended, 500U);
  EXPECT_EQ(counts.passed, 0U);
}

}  // namespace
}  // namespace cluxel::perception
