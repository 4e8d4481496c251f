// SPDX-License-Identifier: Apache-2.0
// Tests that a generated campus is deterministic, complete and plausible, and that its truth agrees with its shapes.
#include "simulation/site/campus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "cluxel/error.hpp"
#include "simulation/campus_fixture.hpp"

namespace cluxel::simulation {

using namespace scan;
namespace {

using Eigen::Vector3d;
using test::smallCampus;

constexpr int kTree = 2, kLamp = 4, kSign = 5, kPole = 6;

bool operator==(const CampusMesh& a, const CampusMesh& b) {
  return a.label == b.label && a.instance == b.instance && a.triangles == b.triangles && a.vertices == b.vertices;
}

TEST(Campus, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const Campus first = buildCampus(smallCampus(1)), again = buildCampus(smallCampus(1)),
               other = buildCampus(smallCampus(2));
  ASSERT_EQ(first.meshes.size(), again.meshes.size());
  for (std::size_t i = 0; i < first.meshes.size(); ++i) ASSERT_TRUE(first.meshes[i] == again.meshes[i]) << "mesh " << i;
  EXPECT_EQ(describeCampus(first), describeCampus(again));
  EXPECT_NE(describeCampus(first), describeCampus(other));
}

TEST(Campus, EveryMeshHasTrianglesWithinItsVerticesAndAnObjectOfItsClass) {
  const Campus campus = buildCampus(smallCampus(4));
  for (const CampusMesh& mesh : campus.meshes) {
    ASSERT_FALSE(mesh.triangles.empty());
    for (const auto& triangle : mesh.triangles)
      for (const auto corner : triangle) ASSERT_LT(corner, mesh.vertices.size());
    const SurfaceInfo& info = infoOf(mesh.label);
    if (info.object_class.empty())
      EXPECT_EQ(mesh.instance, -1);
    else
      EXPECT_EQ(campus.objects.at(static_cast<std::size_t>(mesh.instance)).class_number, info.object_number);
  }
}

/// The number of objects of each class with at least 20 points in the scans.
std::map<int, int> seenObjects(const CampusParams& params) {
  const Campus campus = buildCampus(params);
  std::map<std::int32_t, int> points;
  for (const SimulatedScan& scan : test::scanAll(campus))
    for (const std::int32_t id : scan.truth.instance) ++points[id];
  std::map<int, int> seen;
  for (const auto& [id, count] : points)
    if (id >= 0 && count >= 20) ++seen[campus.objects[static_cast<std::size_t>(id)].class_number];
  return seen;
}

TEST(Campus, OfDefaultSizeShowsEveryClassForSeveralSeeds) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    CampusParams params;
    params.seed = seed;
    params.points_per_stop = 60'000;
    const auto seen = seenObjects(params);
    for (int class_number = 0; class_number < 9; ++class_number)
      EXPECT_GE(seen.contains(class_number) ? seen.at(class_number) : 0, class_number == 0 ? 1 : 3)
          << "class " << class_number << ", seed " << seed;
  }
}

TEST(Campus, OfSmallSizeStillShowsEveryClass) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const auto seen = seenObjects(smallCampus(seed));
    for (int class_number = 0; class_number < 9; ++class_number)
      EXPECT_TRUE(seen.contains(class_number)) << "class " << class_number << ", seed " << seed;
  }
}

TEST(Campus, HasTheHardCasesOfThePaper) {
  CampusParams params;
  for (params.seed = 1; params.seed < 4; ++params.seed) {
    const Campus campus = buildCampus(params);
    const auto having = [&campus](int class_number, const std::string& trait) {
      return std::count_if(campus.objects.begin(), campus.objects.end(), [&](const CampusObject& object) {
        return object.class_number == class_number &&
               std::any_of(object.traits.begin(), object.traits.end(),
                           [&trait](const std::string& own) { return own.starts_with(trait); });
      });
    };
    EXPECT_GE(having(kLamp, "under a crown"), 1) << "seed " << params.seed;
    EXPECT_GE(having(kSign, "under a crown"), 2) << "seed " << params.seed;
    EXPECT_GE(having(kSign, "leaves on top"), 1) << "seed " << params.seed;
    EXPECT_GE(having(kSign, "two plates"), 1) << "seed " << params.seed;
    EXPECT_GE(having(kTree, "crown touches"), 4) << "seed " << params.seed;
  }
}

/// The number of objects of each kind on the campus; fences are counted by their trait.
std::map<std::string, int> kindsOf(const Campus& campus) {
  std::map<std::string, int> kinds;
  for (const CampusObject& object : campus.objects) ++kinds[object.kind == "fence" ? object.traits.at(0) : object.kind];
  return kinds;
}

TEST(Campus, HasFencesOfEveryKindAndCyclesWherePeopleLeaveThem) {
  CampusParams params;
  std::map<std::string, int> of_all;
  for (params.seed = 1; params.seed < 4; ++params.seed) {
    auto kinds = kindsOf(buildCampus(params));
    EXPECT_GE(kinds["bicycle"], 8) << "seed " << params.seed;
    EXPECT_GE(kinds["motorcycle"], 1) << "seed " << params.seed;
    for (const auto& [kind, count] : kinds) of_all[kind] += count;
  }
  for (const char* kind : {"pickets", "bars", "wire mesh", "boards", "low wall"}) EXPECT_GE(of_all[kind], 4) << kind;
}

TEST(Campus, FencesAreLowAndThinAndStandOnTheGround) {
  const Campus campus = buildCampus(smallCampus(2));
  int fences = 0;
  for (const CampusMesh& mesh : campus.meshes) {
    if (mesh.label != SurfaceLabel::Fence) continue;
    double low = 1e9, high = -1e9;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
    for (const auto& vertex : mesh.vertices) {
      const Vector3d p = vertex.cast<double>();
      const double above = p.z() - campus.terrain.heightAt(p.x(), p.y());
      low = std::min(low, above), high = std::max(high, above);
      const Eigen::Vector2d plan = p.head<2>() - mesh.vertices[0].cast<double>().head<2>();
      sum += plan, products += plan * plan.transpose();
    }
    const auto n = static_cast<double>(mesh.vertices.size());
    const Eigen::Matrix2d spread = products / n - sum * sum.transpose() / (n * n);
    const double thin = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues()(0);
    EXPECT_LT(low, 0.15);
    EXPECT_GT(high, 0.5);
    EXPECT_LT(high, 2.2);
    EXPECT_LT(std::sqrt(std::max(0.0, thin)), 0.25) << "standard deviation across the fence [m]";
    ++fences;
  }
  EXPECT_GE(fences, 5);
}

TEST(Campus, ThicketsAreLeavesOfNoObjectAndNoHigherThanTheyAreSaidToBe) {
  int thickets = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Campus campus = buildCampus(smallCampus(seed));
    for (const CampusMesh& mesh : campus.meshes) {
      if (mesh.label != SurfaceLabel::Thicket) continue;
      EXPECT_EQ(mesh.instance, -1);
      double high = 0;
      for (const auto& vertex : mesh.vertices)
        high = std::max(high, vertex.z() - campus.terrain.heightAt(vertex.x(), vertex.y()));
      EXPECT_GT(high, 1.2);
      EXPECT_LT(high, 3.5);
      ++thickets;
    }
  }
  EXPECT_GE(thickets, 3);
}

TEST(Campus, ThicketsThatOneLooksOverAreBushes) {
  int bushes = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    CampusParams params;
    params.seed = seed;
    const Campus campus = buildCampus(params);
    for (const CampusMesh& mesh : campus.meshes) {
      if (mesh.instance < 0) continue;
      const CampusObject& object = campus.objects[static_cast<std::size_t>(mesh.instance)];
      if (object.kind != "thicket") continue;
      EXPECT_EQ(object.class_number, 3);
      EXPECT_EQ(mesh.label, SurfaceLabel::HedgeTop);
      double high = 0;
      for (const auto& vertex : mesh.vertices)
        high = std::max(high, vertex.z() - campus.terrain.heightAt(vertex.x(), vertex.y()));
      EXPECT_GT(high, 0.4);
      EXPECT_LT(high, 1.9);
      ++bushes;
    }
  }
  EXPECT_GE(bushes, 3);
}

/// A place in a frame along the street, to which walls and cars are parallel.
Eigen::Vector2d inPlan(const Campus& campus, const Vector3d& p_map) {
  return Eigen::Rotation2Dd(-campus.heading_rad) * p_map.head<2>();
}

/// Footprints in which no other object may stand: walls of buildings and bodies of cars, by instance.
std::map<std::int32_t, Eigen::AlignedBox2d> solidPlans(const Campus& campus) {
  std::map<std::int32_t, Eigen::AlignedBox2d> plans;
  for (const CampusMesh& mesh : campus.meshes)
    if (mesh.label == SurfaceLabel::Facade || mesh.label == SurfaceLabel::CarBody)
      for (const auto& vertex : mesh.vertices) plans[mesh.instance].extend(inPlan(campus, vertex.cast<double>()));
  return plans;
}

bool isPost(const CampusObject& object) {
  return object.class_number >= kLamp && object.class_number <= kPole;
}

TEST(Campus, NothingStandsInABuildingOrACar) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    CampusParams params;
    params.seed = seed;
    const Campus campus = buildCampus(params);
    const auto plans = solidPlans(campus);
    EXPECT_GT(plans.size(), 10U);
    for (std::size_t i = 1; i < campus.objects.size(); ++i)
      for (const auto& [id, plan] : plans) {
        const CampusObject& object = campus.objects[i];
        EXPECT_FALSE(id != static_cast<std::int32_t>(i) && plan.contains(inPlan(campus, object.position)))
            << object.kind << " " << i << " in " << campus.objects[static_cast<std::size_t>(id)].kind << ", seed "
            << seed;
      }
  }
}

TEST(Campus, PostsKeepTheirDistance) {
  CampusParams params;
  for (params.seed = 1; params.seed < 4; ++params.seed) {
    const Campus campus = buildCampus(params);
    for (const CampusObject& object : campus.objects)
      for (const CampusObject& other : campus.objects) {
        if (&object != &other && isPost(object) && isPost(other)) {
          EXPECT_GT((object.position - other.position).head<2>().norm(), 0.35) << "seed " << params.seed;
        }
      }
  }
}

TEST(Campus, GroundRollsGentlyAndIsNotFlat) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Campus campus = buildCampus(smallCampus(seed));
    EXPECT_LT(campus.terrain.steepest(), 0.20) << "seed " << seed;
    double lowest = 1e9, highest = -1e9;
    for (double x = -25; x <= 25; x += 5)
      for (double y = -25; y <= 25; y += 5) {
        lowest = std::min(lowest, campus.terrain.heightAt(x, y));
        highest = std::max(highest, campus.terrain.heightAt(x, y));
      }
    EXPECT_GT(highest - lowest, 0.15) << "seed " << seed;
  }
}

TEST(Campus, StopsAreTenMetresApartAndTheSensorIsWhereARobotCarriesIt) {
  CampusParams params;
  const Campus campus = buildCampus(params);
  ASSERT_EQ(campus.stops.size(), 12U);
  for (std::size_t i = 0; i < campus.stops.size(); ++i) {
    const Vector3d p = campus.stops[i].translation();
    EXPECT_NEAR(p.z() - campus.terrain.heightAt(p.x(), p.y()), 1.2, 0.1);
    EXPECT_GT(campus.stops[i].linear()(2, 2), std::cos(0.12));
    if (i > 0) {
      EXPECT_LT((p - campus.stops[i - 1].translation()).norm(), 10.7);
      EXPECT_GT((p - campus.stops[i - 1].translation()).norm(), 6.5);  // around a corner
    }
  }
}

TEST(Campus, PointsLieWithinTheBoxOfTheirObject) {
  CampusParams params = smallCampus(6);
  params.mixed_pixel_probability = 0;
  const Campus campus = buildCampus(params);
  for (const SimulatedScan& scan : test::scanAll(campus))
    for (std::size_t i = 0; i < scan.truth.instance.size(); ++i) {
      const std::int32_t id = scan.truth.instance[i];
      if (id < 0) continue;
      const CampusObject& object = campus.objects[static_cast<std::size_t>(id)];
      const Vector3d p =
          toMap(scan.scan.T_map_sensor, {scan.scan.points.x[i], scan.scan.points.y[i], scan.scan.points.z[i]});
      ASSERT_LT(object.box.exteriorDistance(p), 6 * params.range_sigma_m + 1e-3) << object.kind;
    }
}

TEST(Campus, RefusesParametersOutOfRangeNamingTheRemedy) {
  CampusParams params;
  for (const auto& [stops, remedy] : {std::pair(50, "choose fewer stops or a size of "),
                                      std::pair(500, "choose fewer stops, nearer to each other")}) {
    params.stops = stops;
    try {
      buildCampus(params);
      FAIL() << "took " << stops << " stops";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
      EXPECT_THAT(error.what(), testing::HasSubstr(remedy)) << "no campus is larger than 400 m";
    }
  }
  params = {};
  params.size_m = 10;
  EXPECT_THROW(buildCampus(params), Error);
  params = {};
  params.stops = 2.5;
  EXPECT_THROW(buildCampus(params), Error);
}

TEST(Campus, OffersEveryStopThatItCounts) {
  CampusParams params;
  params.stops = static_cast<double>(maxStops(params.size_m));
  EXPECT_EQ(buildCampus(params).stops.size(), maxStops(params.size_m));
  EXPECT_GE(maxStops(params.size_m), 15U);
}

}  // namespace
}  // namespace cluxel::simulation
