// SPDX-License-Identifier: Apache-2.0
// Compares the laser with analytic geometry, and its noise with its parameters.
#include "simulation/laser/laser.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "cluxel/error.hpp"
#include "simulation/campus_fixture.hpp"
#include "simulation/makers/mesh_shapes.hpp"

namespace cluxel::simulation {

using namespace scan;
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
  addQuad(plane,
          {middle - 90 * u - 90 * v, middle + 90 * u - 90 * v, middle + 90 * u + 90 * v, middle - 90 * u + 90 * v});
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

/// A wall of 18 m before the origin, in the plane of this x.
CampusMesh wallAt(double x) {
  CampusMesh wall;
  addQuad(wall, {Vector3d{x, -9, -9}, Vector3d{x, 9, -9}, Vector3d{x, 9, 9}, Vector3d{x, -9, 9}});
  return wall;
}

TEST(Laser, SeesTheNearestOfSeveralSurfaces) {
  Campus campus;
  for (const double x : {8.0, 3.0, 5.0}) campus.meshes.push_back(wallAt(x));
  const auto hit = Laser(campus).cast(Vector3d::Zero(), Vector3d::UnitX());
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->mesh, 1U);
  EXPECT_NEAR(hit->range_m, 3, 1e-6);
  EXPECT_FALSE(Laser(campus).cast(Vector3d::Zero(), -Vector3d::UnitX()));
}

/// Embree's ranges differ in the last bits between processors, so that they must not decide.
TEST(Laser, SeesTheNearestOfSurfacesThatAreCloserThanFloatsTell) {
  Campus campus;
  constexpr std::array kOrder = {3, 1, 4, 0, 2};
  for (const int place : kOrder) campus.meshes.push_back(wallAt(20 + place * 0x1p-19));
  const Laser laser(campus);
  CampusRandom random{5};
  for (int i = 0; i < 2000; ++i) {
    const Vector3d aim{20, 16 * (random.uniform() - 0.5), 16 * (random.uniform() - 0.5)};
    const auto hit = laser.cast(Vector3d::Zero(), aim.normalized());
    ASSERT_TRUE(hit);
    EXPECT_EQ(kOrder.at(hit->mesh), 0) << aim.transpose();
  }
}

TEST(Laser, SeesTheFirstOfEqualSurfaces) {
  Campus campus;
  for (int i = 0; i < 7; ++i) campus.meshes.push_back(wallAt(20));
  const Laser laser(campus);
  CampusRandom random{6};
  for (int i = 0; i < 2000; ++i) {
    const double y = 16 * (random.uniform() - 0.5), z = i % 2 == 0 ? y : 16 * (random.uniform() - 0.5);
    const auto hit = laser.cast(Vector3d::Zero(), Vector3d{20, y, z}.normalized());  // also where triangles meet
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->mesh, 0U) << y << ' ' << z;
  }
}

/// A campus of several visits has one for each object of each visit. Embree starts some 1000 devices.
TEST(Laser, MoreOfThemThanEmbreeHasDevicesWorkAtOnce) {
  const Campus campus = room(smallCampus(1), 6);
  std::vector<Laser> lasers;
  for (int i = 0; i < 1100; ++i) lasers.emplace_back(campus);
  for (const Laser& laser : lasers) ASSERT_TRUE(laser.cast(Vector3d::Zero(), Vector3d::UnitX()));
}

TEST(Laser, RefusesAStopThatIsNotThere) {
  const Campus campus = room(smallCampus(1), 6);
  EXPECT_THROW(Laser(campus).scanAt(1), Error);
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

double tiltOf(const SimulatedScan& scan, std::size_t i) {
  const Vector3f p = pointOf(scan, i);
  return std::atan2(p.z(), p.head<2>().norm());
}

TEST(Laser, LosesTheChosenShareOfRays) {
  CampusParams params = withoutNoise(smallCampus(3));
  params.miss_probability = 0.3;
  const Campus campus = room(params, 6);
  const SimulatedScan scan = Laser(campus).scanAt(0);
  std::vector<double> steps;  // in tilt from one point to the next of the same column
  for (std::size_t i = 1; i < scan.scan.points.size(); ++i)
    if (const double step = tiltOf(scan, i) - tiltOf(scan, i - 1); step > 0) steps.push_back(step);
  auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double limit = 1.5 * *middle;  // more than half of the steps skip no ray
  const auto gaps = std::count_if(steps.begin(), steps.end(), [limit](double step) { return step > limit; });
  EXPECT_NEAR(static_cast<double>(gaps) / static_cast<double>(steps.size()), 0.3, 0.015);
}

TEST(Laser, GlassSwallowsItsShareOfRays) {
  Campus campus = room(withoutNoise(smallCampus(3)), 6);
  CampusMesh pane = campus.meshes[0];
  pane.vertices.clear();
  pane.triangles.clear();
  pane.transparency = 0.6F;
  addQuad(pane, {Vector3d{5.9, -6, -6}, Vector3d{5.9, 6, -6}, Vector3d{5.9, 6, 6}, Vector3d{5.9, -6, 6}});
  campus.meshes.push_back(pane);
  const SimulatedScan scan = Laser(campus).scanAt(0);
  double before = 0, behind = 0;  // in equal cones around +x and -x
  for (std::size_t i = 0; i < scan.scan.points.size(); ++i) {
    const Vector3f direction = pointOf(scan, i).normalized();
    before += direction.x() > 0.8F ? 1 : 0;
    behind += direction.x() < -0.8F ? 1 : 0;
  }
  EXPECT_NEAR(before / behind, 0.4, 0.02);
}

TEST(Laser, LosesRaysThatGrazeTheGround) {
  Campus campus;
  campus.params = withoutNoise(smallCampus(3));
  CampusMesh ground;
  addQuad(ground, {Vector3d{-80, -80, -1.2}, Vector3d{80, -80, -1.2}, Vector3d{80, 80, -1.2}, Vector3d{-80, 80, -1.2}});
  campus.meshes.push_back(ground);
  campus.objects.emplace_back();
  campus.stops.push_back(Eigen::Isometry3d::Identity());
  const SimulatedScan scan = Laser(campus).scanAt(0);
  double flat = 0, steep = 0;  // returns per degree of tilt
  for (std::size_t i = 0; i < scan.scan.points.size(); ++i) {
    const double below_deg = -tiltOf(scan, i) * 180 / 3.14159265;
    flat += below_deg > 1.5 && below_deg < 3.5 ? 0.5 : 0;
    steep += below_deg > 30 && below_deg < 40 ? 0.1 : 0;
  }
  // The share kept is 1 - exp(-sin(tilt)/0.045): 0.62 on average between 1.5 and 3.5 degrees, 1 above 30
  // degrees.
  EXPECT_NEAR(flat / steep, 0.61, 0.06);
}

/// Points that are farther than `tolerance_m` from the surface that a ray in their direction hits.
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
  EXPECT_LT(clean, 200U);  // only where a float's direction falls beside an edge
  EXPECT_GT(mixed, 1000U);
  EXPECT_LT(mixed, 14'000U);
}

using Cell = std::pair<long, long>;

/// Means of `value` over cells of 0.5 m for points of one surface type; `place` gives grid coordinates.
template <typename Place, typename Value>
std::map<Cell, double> cellMeans(const SimulatedScan& scan, SurfaceLabel label, const Place& place,
                                 const Value& value) {
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
  EXPECT_LT(largest, 0.025);  // nine points with 12 mm of noise each, and edges of the street's camber
}

TEST(Laser, TwoStopsAgreeOnTheSameGround) {
  CampusParams params = smallCampus(2);
  params.points_per_stop = 150'000;
  params.stops = 2;
  params.mixed_pixel_probability = 0;
  const Campus campus = buildCampus(params);
  const auto scans = test::scanAll(campus);
  const auto means = [&campus](const SimulatedScan& scan) {
    return cellMeans(
        scan, SurfaceLabel::Sidewalk,
        [](const Vector3d& p) {
          return Eigen::Vector2d{p.x(), p.y()};
        },
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
  campus.stops.push_back(Eigen::Translation3d(3, -4, 1) *
                         Eigen::AngleAxisd(2.2, Vector3d{0.02, -0.03, 1}.normalized()));
  const auto scans = test::scanAll(campus);
  const auto means = [](const SimulatedScan& scan) {
    return cellMeans(
        scan, SurfaceLabel::Facade,
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
}  // namespace cluxel::simulation
