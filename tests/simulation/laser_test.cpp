// SPDX-License-Identifier: Apache-2.0
// The laser against geometry that is known on paper, and its noise against its own figures.
#include "cluxel/simulation/laser.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "simulation/campus_fixture.hpp"
#include "simulation/mesh_shapes.hpp"

namespace cluxel {
namespace {

using Eigen::Vector3d, Eigen::Vector3f;
using test::room, test::smallCampus, test::withoutNoise;

Vector3f pointOf(const SimulatedScan& scan, std::size_t i) {
  return {scan.scan.points.x[i], scan.scan.points.y[i], scan.scan.points.z[i]};
}

TEST(Laser, MeetsAPlaneWhereTheFormulaSaysForAnyDirection) {
  Campus campus;
  CampusMesh plane;
  const Vector3d normal = Vector3d{1, -2, 0.5}.normalized(), u = normal.unitOrthogonal(), v = normal.cross(u);
  const Vector3d middle = 7.25 * normal;
  addQuad(plane, {middle - 90 * u - 90 * v, middle + 90 * u - 90 * v, middle + 90 * u + 90 * v, middle - 90 * u + 90 * v});
  campus.meshes.push_back(plane);
  const Laser laser(campus);
  CampusRandom random{42};
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d direction = randomDirection(random), origin = 3 * randomDirection(random);
    const double along = normal.dot(direction), range = (7.25 - normal.dot(origin)) / along;
    const auto hit = laser.cast(origin, direction);
    if (range < 0 || range > 59) {
      EXPECT_FALSE(hit && hit->range_m < 59);
      continue;
    }
    ASSERT_TRUE(hit) << "range " << range << " m";
    EXPECT_NEAR(hit->range_m, range, 1e-4);
    EXPECT_NEAR(hit->cos_incidence, std::abs(along), 1e-5);
    ++hits;
  }
  EXPECT_GT(hits, 500);
}

TEST(Laser, SeesTheNearestOfSeveralSurfaces) {
  Campus campus;
  for (const double x : {8.0, 3.0, 5.0}) {
    CampusMesh wall;
    addQuad(wall, {Vector3d{x, -9, -9}, Vector3d{x, 9, -9}, Vector3d{x, 9, 9}, Vector3d{x, -9, 9}});
    campus.meshes.push_back(wall);
  }
  const auto hit = Laser(campus).cast(Vector3d::Zero(), Vector3d::UnitX());
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->mesh, 1U);
  EXPECT_NEAR(hit->range_m, 3, 1e-6);
  EXPECT_FALSE(Laser(campus).cast(Vector3d::Zero(), -Vector3d::UnitX()));
}

TEST(Laser, WithoutNoiseEveryPointLiesOnTheWallsOfARoom) {
  const Campus campus = room(withoutNoise(smallCampus(1)), 6);
  const SimulatedScan scan = Laser(campus).scanAt(0);
  ASSERT_GT(scan.scan.points.size(), 30'000U);
  for (std::size_t i = 0; i < scan.scan.points.size(); ++i)
    ASSERT_NEAR(pointOf(scan, i).cwiseAbs().maxCoeff(), 6, 1e-4) << "point " << i;
}

TEST(Laser, RangeNoiseHasTheChosenDeviationAndNoBias) {
  CampusParams params = withoutNoise(smallCampus(3));
  params.range_sigma_m = 0.015;
  const Campus campus = room(params, 6);
  const Laser laser(campus);
  const SimulatedScan scan = laser.scanAt(0);
  std::vector<double> errors_m;
  for (std::size_t i = 0; i < scan.scan.points.size(); ++i) {
    const Vector3d p = pointOf(scan, i).cast<double>();
    errors_m.push_back(p.norm() - laser.cast(Vector3d::Zero(), p.normalized())->range_m);
  }
  const auto n = static_cast<double>(errors_m.size());
  const double mean = std::accumulate(errors_m.begin(), errors_m.end(), 0.0) / n;
  const double square = std::inner_product(errors_m.begin(), errors_m.end(), errors_m.begin(), 0.0) / n;
  EXPECT_NEAR(mean, 0, 0.0004);
  EXPECT_NEAR(std::sqrt(square - mean * mean), 0.015, 0.0004);
}

TEST(Laser, LosesTheChosenShareOfRaysAndNearlyAllThatGraze) {
  CampusParams params = withoutNoise(smallCampus(3));
  const Campus sharp = room(params, 6);
  params.miss_probability = 0.3;
  const Campus lossy = room(params, 6);
  // Both aim for the same number of returns, so the lossy one sends more rays: compare rays by their directions' spacing.
  const auto& first = Laser(sharp).scanAt(0).scan.points;
  const auto& second = Laser(lossy).scanAt(0).scan.points;
  EXPECT_NEAR(static_cast<double>(first.size()), 40'000, 2000);
  EXPECT_NEAR(static_cast<double>(second.size()), 40'000, 2000);
  EXPECT_NE(first.x, second.x);
}

/// Points that lie on no surface: farther than `tolerance_m` from what a ray in their direction meets.
std::size_t pointsInTheAir(const Campus& campus, double tolerance_m) {
  const Laser laser(campus);
  const SimulatedScan scan = laser.scanAt(0);
  const Eigen::Isometry3d& T_map_sensor = campus.stops[0];
  std::size_t in_the_air = 0;
  for (std::size_t i = 0; i < scan.scan.points.size(); ++i) {
    const Vector3d p = pointOf(scan, i).cast<double>();
    const auto hit = laser.cast(T_map_sensor.translation(), T_map_sensor.linear() * p.normalized());
    in_the_air += !hit || std::abs(hit->range_m - p.norm()) > tolerance_m ? 1 : 0;
  }
  return in_the_air;
}

TEST(Laser, MixesPixelsAtDepthEdgesOnlyWhenAsked) {
  CampusParams params = withoutNoise(smallCampus(5));
  const std::size_t clean = pointsInTheAir(buildCampus(params), 0.05);
  params.mixed_pixel_probability = 0.6;
  params.beam_radius_rad = 0.003;
  const std::size_t mixed = pointsInTheAir(buildCampus(params), 0.05);
  EXPECT_LT(clean, 200U);      // only where a float's direction falls beside an edge
  EXPECT_GT(mixed, 1000U);
  EXPECT_LT(mixed, 14'000U);
}

using Cell = std::pair<long, long>;

/// Means of `value` over cells of 0.5 m, for the points of one kind of surface that `place` puts on a grid.
template <typename Place, typename Value>
std::map<Cell, double> cellMeans(const SimulatedScan& scan, SurfaceLabel label, const Place& place, const Value& value) {
  std::map<Cell, std::pair<double, int>> sums;
  for (std::size_t i = 0; i < scan.scan.points.size(); ++i) {
    if (scan.scan.points.label[i] != static_cast<std::uint32_t>(label)) continue;
    const Vector3d p = toMap(scan.scan.T_map_sensor, pointOf(scan, i));
    const Eigen::Vector2d at = place(p);
    auto& [sum, count] = sums[{std::lround(std::floor(2 * at.x())), std::lround(std::floor(2 * at.y()))}];
    sum += value(p);
    ++count;
  }
  std::map<Cell, double> means;
  for (const auto& [cell, sum] : sums)
    if (sum.second >= 9) means[cell] = sum.first / sum.second;
  return means;
}

void expectAgreement(const std::map<Cell, double>& first, const std::map<Cell, double>& second, int least_cells) {
  int compared = 0;
  double largest = 0;
  for (const auto& [cell, mean] : first)
    if (const auto other = second.find(cell); other != second.end()) {
      ++compared;
      largest = std::max(largest, std::abs(mean - other->second));
    }
  EXPECT_GE(compared, least_cells);
  EXPECT_LT(largest, 0.025);      // nine points with 12 mm of noise each, and edges of the street's camber
}

TEST(Laser, TwoStopsAgreeOnTheSameGround) {
  CampusParams params = smallCampus(2);
  params.points_per_stop = 150'000;
  params.stops = 2;
  params.mixed_pixel_probability = 0;
  const Campus campus = buildCampus(params);
  const auto scans = test::scanAll(campus);
  const auto means = [&campus](const SimulatedScan& scan) {
    return cellMeans(scan, SurfaceLabel::Sidewalk, [](const Vector3d& p) { return Eigen::Vector2d{p.x(), p.y()}; },
                     [&campus](const Vector3d& p) { return p.z() - campus.terrain.heightAt(p.x(), p.y()); });
  };
  expectAgreement(means(scans[0]), means(scans[1]), 20);
}

TEST(Laser, TwoStopsAgreeOnTheSameWall) {
  CampusParams params = withoutNoise(smallCampus(2));
  params.points_per_stop = 150'000;
  params.range_sigma_m = 0.012;
  Campus campus = room(params, 12);
  campus.meshes[0].label = SurfaceLabel::Facade;
  campus.stops.push_back(Eigen::Translation3d(3, -4, 1) * Eigen::AngleAxisd(2.2, Vector3d{0.02, -0.03, 1}.normalized()));
  const auto scans = test::scanAll(campus);
  const auto means = [](const SimulatedScan& scan) {
    return cellMeans(scan, SurfaceLabel::Facade,
                     [](const Vector3d& p) {
                       const bool wall = p.y() > 11.5 && std::abs(p.x()) < 11 && std::abs(p.z()) < 11;
                       return wall ? Eigen::Vector2d{p.x(), p.z()} : Eigen::Vector2d{99, 99};
                     },
                     [](const Vector3d& p) { return p.y(); });
  };
  auto first = means(scans[0]), second = means(scans[1]);
  first.erase({198, 198});
  second.erase({198, 198});
  expectAgreement(first, second, 400);
}

}  // namespace
}  // namespace cluxel
