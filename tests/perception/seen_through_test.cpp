// SPDX-License-Identifier: Apache-2.0
// Rays tell that something is gone only where they would have hit it: thin poles, and faces seen edge-on.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "perception/visibility/presence.hpp"
#include "perception/visibility/scan_rays.hpp"

namespace cluxel::perception {
namespace {

using Points = std::vector<Eigen::Vector3d>;

/// An even grid of directions.
struct Grid {
  double pan_step = 0, tilt_step = 0;  ///< [rad]
  double pan = 0, tilt = 0;            ///< of the first ray
};

constexpr double kGround_m = 0, kError_m = 0.008;

/// The rays of a laser towards a thing, and to the other side. `rangeOf(way)` is where a ray meets the thing; then come
/// the ground and a wall 15 m away, towards the thing only where it `has_wall`.
template <typename RangeOf>
Points endsSeen(const Eigen::Vector3d& sensor, double towards_rad, const Grid& grid, bool has_wall,
                std::mt19937& random, const RangeOf& rangeOf) {
  std::normal_distribution<double> error(0, kError_m);
  Points ends;
  for (const double side : {towards_rad, towards_rad + std::numbers::pi})
    for (double tilt = -0.5 + grid.tilt; tilt < 0.5; tilt += grid.tilt_step)
      for (double pan = side - 0.25 + grid.pan; pan < side + 0.25; pan += grid.pan_step) {
        const Eigen::Vector3d way(std::cos(tilt) * std::cos(pan), std::cos(tilt) * std::sin(pan), std::sin(tilt));
        double range_m = way.z() < 0 ? (sensor.z() - kGround_m) / -way.z() : 1e9;
        range_m = std::min(range_m, rangeOf(way).value_or(1e9));
        if (has_wall || side != towards_rad) range_m = std::min(range_m, 15.0);
        if (range_m < 60) ends.push_back(sensor + (range_m + error(random)) * way);
      }
  return ends;
}

ScanRays raysTo(const Points& ends, const Eigen::Vector3d& sensor) {
  scan::Scan scan;
  scan.has_pose = true;
  scan.T_map_sensor = Eigen::Translation3d(sensor) * Eigen::Isometry3d::Identity();
  for (const Eigen::Vector3d& end : ends) {
    const Eigen::Vector3f p = (end - sensor).cast<float>();
    scan.points.x.push_back(p.x()), scan.points.y.push_back(p.y()), scan.points.z.push_back(p.z());
  }
  return ScanRays(scan);
}

/// A place for each cell of 0.3 m in which there are points, with the box around them and those of the cells beside.
std::vector<Place> placesOf(const Points& points) {
  using Cell = std::array<int, 3>;
  std::map<Cell, Points> cells;
  for (const Eigen::Vector3d& p : points)
    cells[{static_cast<int>(std::floor(p.x() / 0.3)), static_cast<int>(std::floor(p.y() / 0.3)),
           static_cast<int>(std::floor(p.z() / 0.3))}]
        .push_back(p);
  std::vector<Place> places;
  for (const auto& [cell, own] : cells) {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : own) at += p / static_cast<double>(own.size());
    Eigen::AlignedBox3d box;
    for (const auto& [other, there] : cells)
      if (std::abs(other[0] - cell[0]) <= 1 && std::abs(other[1] - cell[1]) <= 1 && std::abs(other[2] - cell[2]) <= 1)
        for (const Eigen::Vector3d& p : there) box.extend(p);
    places.push_back({at, (box.min() - at).cast<float>(), (box.max() - at).cast<float>()});
  }
  return places;
}

struct Look {
  double time_s = 0;
  Eigen::Vector3d sensor;
  Points ends;
};

std::vector<ScanVotes> votesOf(const std::vector<Look>& looks, const std::vector<Place>& places) {
  std::vector<ScanVotes> votes;
  for (const Look& look : looks) {
    const ScanRays rays = raysTo(look.ends, look.sensor);
    ScanVotes of_scan{look.time_s, {}, {}};
    for (std::size_t i = 0; i < places.size(); ++i) {
      const PlaceVerdict found = rays.verdictAt(places[i], {});
      of_scan.hits.set(i, found.verdict == RayVerdict::Hit);
      of_scan.seen_through.set(i, found.verdict == RayVerdict::SeenThrough && !found.is_aside);
    }
    addVotes(votes, of_scan);
  }
  return votes;
}

/// A round pole that stands at the origin, 3 m high, and what a laser sees of it from places around.
struct Pole {
  double radius_m = 0;

  std::optional<double> rangeTo(const Eigen::Vector3d& from, const Eigen::Vector3d& way) const {
    const double a = way.head<2>().squaredNorm(), b = from.head<2>().dot(way.head<2>());
    const double d = b * b - a * (from.head<2>().squaredNorm() - radius_m * radius_m);
    if (d <= 0) return std::nullopt;
    const double range_m = (-b - std::sqrt(d)) / a, z = from.z() + range_m * way.z();
    return range_m > 0 && z > 0 && z < 3 ? std::optional(range_m) : std::nullopt;
  }
};

/// Scans of a pole of which the rays lie `spacing_m` apart there. It stands until the scan `leaves`.
std::vector<Look> looksAt(const Pole& pole, double spacing_m, bool has_wall, int scans, int leaves,
                          std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Look> looks;
  for (int i = 0; i < scans; ++i) {
    const double around = 2 * std::numbers::pi * unit(random), far_m = 5 + 7 * unit(random);
    const Eigen::Vector3d sensor(far_m * std::cos(around), far_m * std::sin(around), 1.7);
    Grid grid{spacing_m / far_m, (0.03 + 0.07 * unit(random)) / far_m, 0, 0};
    grid.pan = grid.pan_step * unit(random), grid.tilt = grid.tilt_step * unit(random);
    const auto range = [&](const Eigen::Vector3d& way) {
      return i < leaves ? pole.rangeTo(sensor, way) : std::nullopt;
    };
    looks.push_back(
        {static_cast<double>(i), sensor, endsSeen(sensor, around + std::numbers::pi, grid, has_wall, random, range)});
  }
  return looks;
}

Points onPole(const std::vector<Look>& looks, const Pole& pole) {
  Points points;
  for (const Look& look : looks)
    for (const Eigen::Vector3d& end : look.ends)
      if (end.head<2>().norm() < pole.radius_m + 0.05 && end.z() > 0.3) points.push_back(end);
  return points;
}

TEST(SeenThrough, AThinPoleThatStandsIsNeverGone) {
  std::mt19937 random(41);
  std::uniform_real_distribution<double> unit(0, 1);
  int told = 0;
  for (int round = 0; round < 60; ++round) {
    const Pole pole{0.04 + 0.11 * unit(random)};
    const double spacing_m = 0.03 + unit(random) * (6 * pole.radius_m - 0.03);
    constexpr int kScans = 14;
    const std::vector<Look> looks = looksAt(pole, spacing_m, round % 3 != 0, kScans, kScans, random);
    const std::vector<ScanVotes> votes = votesOf(looks, placesOf(onPole(looks, pole)));
    for (std::size_t count = 2; count <= votes.size(); ++count) {
      const auto seen = std::span(votes).first(count);
      const Visibility thing = visibilityOf(seen);
      const auto presence = presenceOf(seen, thing, {});
      if (!presence) continue;
      ++told;
      ASSERT_FALSE(presence->seen_through_s) << "radius " << pole.radius_m << ", rays " << spacing_m << " m apart";
      ASSERT_FALSE(presence->seen_empty_s) << "radius " << pole.radius_m << ", rays " << spacing_m << " m apart";
    }
  }
  EXPECT_GT(told, 500);
}

TEST(SeenThrough, AThinPoleThatLeftIsGone) {
  std::mt19937 random(42);
  std::uniform_real_distribution<double> unit(0, 1);
  int found = 0, dense = 0, found_dense = 0;
  constexpr int kRounds = 60;
  for (int round = 0; round < kRounds; ++round) {
    const Pole pole{0.04 + 0.11 * unit(random)};
    const double spacing_m = 0.03 + unit(random) * (6 * pole.radius_m - 0.03);
    const std::vector<Look> looks = looksAt(pole, spacing_m, true, 24, 12, random);
    const std::vector<Look> standing(looks.begin(), looks.begin() + 12);
    const std::vector<ScanVotes> votes = votesOf(looks, placesOf(onPole(standing, pole)));
    const auto presence = presenceOf(votes, visibilityOf(votes), {});
    const bool is_gone = presence && presence->seen_through_s;
    found += is_gone ? 1 : 0;
    if (spacing_m > 2 * pole.radius_m) continue;
    ++dense, found_dense += is_gone ? 1 : 0;
  }
  EXPECT_GT(dense, 10);
  EXPECT_EQ(found_dense, dense);
  EXPECT_GE(found, kRounds * 8 / 10);
}

/// A thing of this width that was at the origin: what a laser 6 m away, with dense rays, finds of it after it left.
PlaceVerdict verdictOfWidth(double width_m) {
  std::mt19937 random(45);
  const Eigen::Vector3d sensor(-6, 0, 1.2);
  const Grid dense{0.001, 0.004, 0, 0};
  const Points ends =
      endsSeen(sensor, 0, dense, true, random, [](const Eigen::Vector3d&) { return std::optional<double>(); });
  const auto half_m = static_cast<float>(width_m / 2);
  const Place place{{0, 0, 1}, {-half_m, -half_m, -0.4F}, {half_m, half_m, 0.4F}};
  return raysTo(ends, sensor).verdictAt(place, {});
}

TEST(SeenThrough, PassingRaysTellNothingOfWires) {
  const PlaceVerdict wire = verdictOfWidth(0.03), post = verdictOfWidth(0.08);
  EXPECT_EQ(wire.verdict, RayVerdict::SeenThrough);
  EXPECT_TRUE(wire.is_aside) << "3 cm are within the errors of points";
  EXPECT_EQ(post.verdict, RayVerdict::SeenThrough);
  EXPECT_FALSE(post.is_aside);
}

/// A thing with a flat top in the plane z = height.
struct Slab {
  Eigen::AlignedBox3d box;

  std::optional<double> rangeTo(const Eigen::Vector3d& from, const Eigen::Vector3d& way) const {
    const Eigen::Array3d a = (box.min() - from).array() / way.array(), b = (box.max() - from).array() / way.array();
    const double enters = a.min(b).maxCoeff(), leaves = a.max(b).minCoeff();
    return enters <= leaves && enters > 0 ? std::optional(enters) : std::nullopt;
  }
};

/// How many places of a roof a laser sees through, of those that some scan measured.
struct RoofLook {
  std::size_t told = 0, aside = 0;
};

/// `stands`: whether the roof is there when the laser looks from `above_m` over it.
RoofLook lookAtRoof(double above_m, double far_m, bool stands, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const Slab car{{Eigen::Vector3d(-1.1, -0.8, 0.6), Eigen::Vector3d(1.1, 0.8, 1.6)}};
  const double around = 2 * std::numbers::pi * unit(random);
  const auto seenFrom = [&](double from_above_m, double from_far_m, bool is_there) {
    const Eigen::Vector3d sensor(from_far_m * std::cos(around), from_far_m * std::sin(around), 1.6 + from_above_m);
    const Grid grid{0.006, 0.002 + 0.008 * unit(random), 0.006 * unit(random), 0.002 * unit(random)};
    const auto range = [&](const Eigen::Vector3d& way) { return is_there ? car.rangeTo(sensor, way) : std::nullopt; };
    return Look{0, sensor, endsSeen(sensor, around + std::numbers::pi, grid, true, random, range)};
  };
  Points roof;
  for (const Eigen::Vector3d& end : seenFrom(1.2, 5, true).ends)
    if (std::abs(end.z() - 1.6) < 0.03 && car.box.exteriorDistance(end) < 0.03) roof.push_back(end);
  const Look look = seenFrom(above_m, far_m, stands);
  const ScanRays rays = raysTo(look.ends, look.sensor);
  RoofLook found;
  for (const Place& place : placesOf(roof)) {
    const PlaceVerdict verdict = rays.verdictAt(place, {});
    if (verdict.verdict != RayVerdict::SeenThrough && verdict.verdict != RayVerdict::FewPassed) continue;
    ++(verdict.is_aside ? found.aside : found.told);
  }
  return found;
}

TEST(SeenThrough, RaysCloseAboveAFlatFaceTellNothingOfIt) {
  std::mt19937 random(43);
  std::uniform_real_distribution<double> unit(0, 1);
  std::size_t aside = 0;
  for (int round = 0; round < 60; ++round) {
    const double above_m = -0.05 + 0.25 * unit(random), far_m = 3 + 8 * unit(random);
    const RoofLook found = lookAtRoof(above_m, far_m, true, random);
    ASSERT_EQ(found.told, 0U) << above_m << " m above, " << far_m << " m away";
    aside += found.aside;
  }
  EXPECT_GT(aside, 200U) << "rays pass it closely";
}

TEST(SeenThrough, RaysFromAboveTellThatAFlatFaceIsGone) {
  std::mt19937 random(44);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int round = 0; round < 20; ++round) {
    const RoofLook found = lookAtRoof(0.8 + unit(random), 4 + 2 * unit(random), false, random);
    EXPECT_GE(found.told, 15U);
    EXPECT_GT(found.told, found.aside);
  }
}

/// A lawn, uneven by 5 cm, as a laser of 0.4 degrees between its rings sees it on a drive.
std::vector<Look> driveOverLawn(int scans, double first_ring, std::mt19937& random) {
  std::normal_distribution<double> error(0, 0.02);
  const auto heightAt = [](double x, double y) { return 0.05 * std::sin(2.1 * x) * std::sin(1.7 * y); };
  std::vector<Look> looks;
  for (int i = 0; i < scans; ++i) {
    const Eigen::Vector3d sensor(i, 0, 1.73);
    Points ends;
    for (double tilt = first_ring; tilt > -0.25; tilt -= 0.007)
      for (double pan = -0.2; pan < 0.2; pan += 0.0015) {
        const Eigen::Vector3d way(std::cos(tilt) * std::cos(pan), std::cos(tilt) * std::sin(pan), std::sin(tilt));
        double range_m = 0;
        for (int step = 0; step < 20; ++step) {
          const Eigen::Vector3d end = sensor + range_m * way;
          range_m = (sensor.z() - heightAt(end.x(), end.y())) / -way.z();
        }
        ends.push_back(sensor + (range_m + error(random)) * way);
      }
    looks.push_back({0.1 * i, sensor, ends});
  }
  return looks;
}

/// How many places of what was measured of a lawn in a circle on the first four scans are seen through on later ones.
std::size_t seenThroughOfLawn(const std::vector<Look>& looks, double far_m, const RayParams& params) {
  constexpr std::size_t kMeasured = 4;
  Points low;
  for (std::size_t i = 0; i < kMeasured; ++i)
    for (const Eigen::Vector3d& end : looks[i].ends)
      if ((end - Eigen::Vector3d(far_m, 0, 0)).norm() < 1.2) low.push_back(end);
  std::size_t told = 0;
  for (std::size_t i = kMeasured; i < looks.size(); ++i) {
    const ScanRays rays = raysTo(looks[i].ends, looks[i].sensor);
    for (const Place& place : placesOf(low)) {
      const PlaceVerdict found = rays.verdictAt(place, params);
      told += found.verdict == RayVerdict::SeenThrough && !found.is_aside ? 1 : 0;
    }
  }
  return told;
}

TEST(SeenThrough, RaysThatGrazeALawnHardlyTellThatItIsGone) {
  std::mt19937 random(46);
  std::uniform_real_distribution<double> unit(0, 1);
  std::size_t without_errors = 0, told = 0;
  for (int round = 0; round < 12; ++round) {
    const std::vector<Look> looks = driveOverLawn(12, -0.035 - 0.007 * unit(random), random);
    const double far_m = 24 + 8 * unit(random);
    without_errors += seenThroughOfLawn(looks, far_m, {.elevation_error_rad = 0});
    told += seenThroughOfLawn(looks, far_m, {});
  }
  EXPECT_GE(without_errors, 20U);
  EXPECT_LE(10 * told, without_errors);
}

}  // namespace
}  // namespace cluxel::perception
