// SPDX-License-Identifier: Apache-2.0
// Later visits to a campus: what events say is what the surfaces show.
#include "simulation/site/site_visits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "cluxel/error.hpp"
#include "simulation/campus_fixture.hpp"
#include "simulation/site/stop_room.hpp"

namespace cluxel::simulation {
namespace {

class SiteVisits : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    CampusParams params = test::smallCampus(12);
    params.size_m = 90;
    campus = new Campus(buildCampus(params));
    site = new VisitedSite(visitSite(*campus, 3));
  }
  static void TearDownTestSuite() {
    delete campus;
    delete site;
  }

  static std::set<std::int32_t> thereOn(std::size_t visit) {
    std::set<std::int32_t> there;
    for (const CampusMesh& mesh : site->visits[visit].meshes) there.insert(mesh.instance);
    return there;
  }
  static Eigen::AlignedBox3d boundsOn(std::size_t visit, std::int32_t instance) {
    Eigen::AlignedBox3d box;
    for (const CampusMesh& mesh : site->visits[visit].meshes)
      if (mesh.instance == instance)
        for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex.cast<double>());
    return box;
  }

  static inline Campus* campus = nullptr;
  static inline VisitedSite* site = nullptr;
};

TEST_F(SiteVisits, EventsExplainEveryDifference) {
  ASSERT_EQ(site->visits.size(), 3);
  for (std::size_t visit = 1; visit < 3; ++visit) {
    std::set<std::int32_t> expected = thereOn(visit - 1);
    for (const SiteEvent& event : site->events) {
      if (event.visit != visit || event.kind == SiteEventKind::Cut || event.kind == SiteEventKind::Hidden) continue;
      if (event.instance >= 0) {
        EXPECT_EQ(expected.erase(event.instance), 1);
      }
      if (event.new_instance >= 0) {
        EXPECT_TRUE(expected.insert(event.new_instance).second);
      }
    }
    EXPECT_EQ(thereOn(visit), expected) << "visit " << visit;
  }
}

TEST_F(SiteVisits, HasEventsOfEachKind) {
  std::map<SiteEventKind, int> count;
  for (const SiteEvent& event : site->events) ++count[event.kind];
  EXPECT_EQ(count.size(), 6);
}

TEST_F(SiteVisits, MovesThingsToFreePlacesOfTheSameSize) {
  for (const SiteEvent& event : site->events) {
    if (event.kind != SiteEventKind::Moved) continue;
    const Eigen::AlignedBox3d before = boundsOn(event.visit - 1, event.instance),
                              after = boundsOn(event.visit, event.new_instance);
    EXPECT_LT((before.sizes() - after.sizes()).norm(), 0.01);
    const double distance = (before.center() - after.center()).head<2>().norm();
    EXPECT_GT(distance, 1.4);
    EXPECT_LT(distance, 6.1);
    EXPECT_TRUE(
        site->visits[event.visit].objects[static_cast<std::size_t>(event.new_instance)].box.isApprox(after, 0.01));
  }
}

TEST_F(SiteVisits, MovesNothingToWhereSomethingArrives) {
  CampusParams params = test::smallCampus(50);  // with seed 50 a car would move into a car that arrives
  params.size_m = 100;
  params.stops = 12;
  const VisitedSite other = visitSite(buildCampus(params), 2);
  const auto boxOf = [&](std::int32_t instance) {
    return other.visits[1].objects[static_cast<std::size_t>(instance)].box;
  };
  std::size_t pairs = 0;
  for (const SiteEvent& moved : other.events)
    for (const SiteEvent& arrived : other.events)
      if (moved.kind == SiteEventKind::Moved && arrived.kind == SiteEventKind::Arrived) {
        ++pairs;
        EXPECT_FALSE(boxOf(moved.new_instance).intersects(boxOf(arrived.new_instance)))
            << moved.new_instance << " moves to where " << arrived.new_instance << " arrives";
      }
  EXPECT_GT(pairs, 0U);
}

TEST_F(SiteVisits, StatesNoPartInWhichLampsAreAlike) {
  std::size_t replaced = 0;
  for (const SiteEvent& event : site->events) {
    if (event.kind != SiteEventKind::Replaced) continue;
    ++replaced;
    double pole_top = 1e300;  // of the lower pole; above it only one of both lamps has a pole
    for (const auto& [visit, lamp] : {std::pair(event.visit - 1, event.instance), {event.visit, event.new_instance}}) {
      double top = -1e300;
      for (const CampusMesh& mesh : site->visits[visit].meshes)
        if (mesh.instance == lamp && mesh.label == SurfaceLabel::LampPole)
          for (const Eigen::Vector3f& vertex : mesh.vertices) top = std::max<double>(top, vertex.z());
      pole_top = std::min(pole_top, top);
    }
    EXPECT_GT(event.gone.min().z(), pole_top - 0.1);
    EXPECT_LT(event.gone.min().z(), pole_top + 0.1);
    EXPECT_EQ(event.gone.min().z(), event.come.min().z());
  }
  EXPECT_GT(replaced, 0U);
}

TEST_F(SiteVisits, CutsTheUpperPart) {
  for (const SiteEvent& event : site->events) {
    if (event.kind != SiteEventKind::Cut) continue;
    const double before = boundsOn(event.visit - 1, event.instance).max().z(),
                 after = boundsOn(event.visit, event.instance).max().z();
    EXPECT_GT(before - after, 0.4);
    EXPECT_NEAR(event.gone.max().z(), before, 0.01);
    EXPECT_NEAR(event.gone.min().z(), after, 0.3);
  }
}

TEST_F(SiteVisits, HidesThingsByVansForOneVisit) {
  std::size_t hidden = 0;
  for (const SiteEvent& event : site->events) {
    if (event.kind != SiteEventKind::Hidden) continue;
    ++hidden;
    EXPECT_TRUE(thereOn(event.visit - 1).contains(event.instance));
    for (std::size_t visit = 0; visit < 3; ++visit)
      EXPECT_EQ(thereOn(visit).contains(event.new_instance), visit == event.visit);
    const auto& objects = site->visits[event.visit].objects;
    const CampusObject &thing = objects[static_cast<std::size_t>(event.instance)],
                       &van = objects[static_cast<std::size_t>(event.new_instance)];
    EXPECT_EQ(van.traits, std::vector<std::string>{"occluder"});
    EXPECT_TRUE(van.box.isApprox(boundsOn(event.visit, event.new_instance), 0.01));
    EXPECT_LT(thing.box.max().z() - thing.position.z(), van.box.sizes().z());
    const Eigen::Vector2d to_van = (van.box.center() - thing.box.center()).head<2>();
    EXPECT_LT(to_van.norm(), 0.5 * (thing.box.sizes().head<2>().sum()) + 0.5 + 1.1);
  }
  EXPECT_GT(hidden, 0U);
}

TEST_F(SiteVisits, LaterVisitsMayHaveFewerStops) {
  Campus few = *campus;
  few.params.later_stops = 2;
  const VisitedSite shorter = visitSite(few, 3);
  ASSERT_EQ(shorter.visits[0].stops.size(), site->visits[0].stops.size());
  for (const std::size_t visit : {1U, 2U}) {
    const auto &all = site->visits[visit].stops, &kept = shorter.visits[visit].stops;
    ASSERT_EQ(kept.size(), 2);
    EXPECT_TRUE(kept[0].isApprox(all[all.size() / 4]));
    EXPECT_TRUE(kept[1].isApprox(all[3 * all.size() / 4]));
  }
  few.params.visits = 3;
  EXPECT_NO_THROW(check(few.params));
  few.params.later_stops = few.params.stops + 1;
  EXPECT_THROW(check(few.params), Error);
}

TEST(SiteVisitsParams, OfLaterVisitsNeedOne) {
  for (const auto& [field, value] : {std::pair(&CampusParams::later_stops, 2.0), {&CampusParams::pose_error_m, 0.05}}) {
    CampusParams params = test::smallCampus(1);
    params.*field = value;
    EXPECT_THROW(check(params), Error);
    params.visits = 2;
    EXPECT_NO_THROW(check(params));
  }
}

/// What may stand in the way of the robot.
struct VisitsCase {
  std::uint64_t seed;
  double stops, size_m, later_stops;
  std::size_t visits;
};

/// The nearest return of a scan that is not from the ground [m].
double nearestThing_m(const Laser& laser, std::size_t stop) {
  const SimulatedScan seen = laser.scanAt(stop);
  const scan::ScanPoints& points = seen.scan.points;
  double nearest = 1e300;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (seen.truth.instance[i] != 0)
      nearest = std::min<double>(nearest, Eigen::Vector3f(points.x[i], points.y[i], points.z[i]).norm());
  return nearest;
}

class RoomAtStops : public testing::TestWithParam<VisitsCase> {};

TEST_P(RoomAtStops, IsLeftByAllThingsOnAllVisits) {
  CampusParams params = test::withoutNoise(test::smallCampus(GetParam().seed));
  params.stops = GetParam().stops, params.size_m = GetParam().size_m, params.later_stops = GetParam().later_stops;
  params.points_per_stop = 1000, params.visits = static_cast<double>(GetParam().visits);
  const VisitedSite visited = visitSite(buildCampus(params), GetParam().visits);
  for (std::size_t visit = 0; visit < visited.visits.size(); ++visit) {
    const Campus& campus = visited.visits[visit];
    const Laser laser(campus);
    for (std::size_t stop = 0; stop < campus.stops.size(); ++stop) {
      EXPECT_TRUE(hasRoom(campus, campus.stops[stop].translation())) << "visit " << visit << ", stop " << stop;
      EXPECT_GT(nearestThing_m(laser, stop), kStopRoom_m) << "visit " << visit << ", stop " << stop;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(SiteVisits, RoomAtStops,
                         testing::Values(VisitsCase{3, 8, 70, 0, 6},     // a car would move onto a stop
                                         VisitsCase{302, 10, 70, 1, 9},  // vans would stand around the laser
                                         VisitsCase{14, 12, 80, 0, 3},   // stops would lie in a fence
                                         VisitsCase{5, 1, 50, 0, 4}));

TEST_F(SiteVisits, IsAFunctionOfTheCampus) {
  const VisitedSite again = visitSite(*campus, 3);
  ASSERT_EQ(again.events.size(), site->events.size());
  for (std::size_t i = 0; i < again.events.size(); ++i) {
    EXPECT_EQ(again.events[i].instance, site->events[i].instance);
    EXPECT_EQ(again.events[i].new_instance, site->events[i].new_instance);
  }
  for (std::size_t visit = 0; visit < 3; ++visit)
    EXPECT_EQ(again.visits[visit].meshes.size(), site->visits[visit].meshes.size());
}

}  // namespace
}  // namespace cluxel::simulation
