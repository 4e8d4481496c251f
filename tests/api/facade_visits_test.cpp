// SPDX-License-Identifier: Apache-2.0
// Changes between visits that the facade tells are those of the task.
#include <gmock/gmock.h>

#include <cmath>

#include "api/facade_campus.hpp"
#include "base/utc_time.hpp"
#include "rdf/map_iris.hpp"
#include "tasks/box_visits.hpp"
#include "tasks/changes/changed_points.hpp"
#include "tasks/changes/site_changes.hpp"

namespace cluxel {
namespace {

/// A car stays, one leaves, one moves, and a part of a wall goes.
class FacadeVisits : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new rdf::ScratchFolder();
    const auto car = [](double x, double y) { return tasks::boxFrom({x, y, 0.25}, {x + 4.2, y + 1.8, 1.5}); };
    const auto wall = [](double to_x) { return tasks::boxFrom({-15, 10, 0}, {to_x, 10.5, 5}); };
    const std::vector<Eigen::Vector3d> sensors{{-5, 0, 1.8}, {-1, -1, 1.8}, {3, 0, 1.8}, {7, 0, 1.8}};
    tasks::writeVisits(
        {{{wall(15), car(-9, 4), car(2, 4), car(-6, -8)}, sensors}, {{wall(10), car(-9, 4), car(2, -8)}, sensors}},
        folder->path() / "scans");
    map = new Map(Map::build({folder->path() / "scans"}, folder->path() / "map.clx", FacadeCampus::options()));
  }
  static void TearDownTestSuite() {
    delete map;
    delete folder;
  }

  static inline rdf::ScratchFolder* folder = nullptr;
  static inline Map* map = nullptr;
};

void expectBox(const Position& min, const Position& max, const Eigen::AlignedBox3d& box) {
  EXPECT_EQ(Eigen::Vector3d(min.x, min.y, min.z), box.min());
  EXPECT_EQ(Eigen::Vector3d(max.x, max.y, max.z), box.max());
}

void expectThing(const mapping::MapReader& reader, const ChangedThing& thing, const tasks::ChangedThing& expected) {
  EXPECT_EQ(thing.object, expected.object ? rdf::iriOfObject(reader.objectIds()[*expected.object]) : "");
  EXPECT_EQ(thing.class_name,
            expected.object ? reader.classNames().nameOf(reader.classOf(*expected.object)) : std::string());
  EXPECT_EQ(thing.is_part, expected.is_part);
  EXPECT_EQ(thing.cluxel_count, expected.cluxels.size());
  expectBox(thing.min, thing.max, expected.box);
}

PresenceState stateOf(perception::PresenceState state) {
  if (state == perception::PresenceState::Present) return PresenceState::Present;
  return state == perception::PresenceState::Absent ? PresenceState::Absent : PresenceState::NotObserved;
}

TEST_F(FacadeVisits, ChangesAreThoseOfTheTask) {
  const mapping::MapReader reader(map->file());
  const tasks::SiteChanges expected = tasks::changesIn(reader, {}, 1);
  const SiteChanges found = map->changes();
  EXPECT_EQ(found.since_s, expected.times.since_s);
  EXPECT_EQ(found.until_s, std::nullopt);
  EXPECT_EQ(found.summary, tasks::summaryOf(expected));
  ASSERT_EQ(found.changes.size(), expected.changes.size());
  std::vector<SiteChangeKind> kinds;
  for (std::size_t i = 0; i < found.changes.size(); ++i) {
    const SiteChange& change = found.changes[i];
    const tasks::SiteChange& wanted = expected.changes[i];
    kinds.push_back(change.kind);
    EXPECT_EQ(change.kind == SiteChangeKind::Moved, wanted.kind == tasks::SiteChange::Kind::Moved);
    EXPECT_EQ(change.kind == SiteChangeKind::Appeared, wanted.kind == tasks::SiteChange::Kind::Appeared);
    EXPECT_EQ(change.distance_m, wanted.distance_m);
    expectThing(reader, change.thing, wanted.thing);
    ASSERT_EQ(change.now.has_value(), wanted.now.has_value());
    if (change.now) expectThing(reader, *change.now, *wanted.now);
  }
  EXPECT_THAT(kinds, ::testing::IsSupersetOf({SiteChangeKind::Vanished, SiteChangeKind::Moved}));
  EXPECT_TRUE(found.points.cloud_ids.empty());
  const auto parts = tasks::statesOfParts(expected);
  ASSERT_EQ(found.parts.size(), parts.size());
  ASSERT_GT(parts.size(), 0U);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    expectThing(reader, found.parts[i].part, *parts[i].part);
    EXPECT_TRUE(found.parts[i].part.is_part);
    EXPECT_EQ(found.parts[i].before, stateOf(parts[i].before));
    EXPECT_EQ(found.parts[i].after, stateOf(parts[i].after));
  }
}

TEST_F(FacadeVisits, StatesOfAllObjectsAreThoseOfTheTask) {
  const mapping::MapReader reader(map->file());
  const tasks::SiteChanges expected = tasks::changesIn(reader, {}, 1);
  const SiteChanges found = map->changes({.threads = 1});
  const std::vector<Object> objects = map->objects();
  ASSERT_EQ(found.states.size(), expected.states.size());
  std::size_t gone = 0, there = 0;
  for (std::size_t i = 0; i < found.states.size(); ++i) {
    const ObjectStates& states = found.states[i];
    const tasks::ObjectStates& wanted = expected.states[i];
    EXPECT_EQ(states.iri, objects.at(states.number).iri);
    EXPECT_EQ(states.number, wanted.object);
    EXPECT_TRUE(objects[states.number].class_iri.ends_with("#" + states.class_name));
    EXPECT_EQ(states.before, stateOf(wanted.before));
    EXPECT_EQ(states.after, stateOf(wanted.after));
    EXPECT_EQ(states.log_odds_before, wanted.log_odds_before);
    EXPECT_EQ(states.log_odds_after, wanted.log_odds_after);
    EXPECT_EQ(states.coverage_before, wanted.coverage_before);
    EXPECT_EQ(states.coverage_after, wanted.coverage_after);
    expectBox(states.min, states.max, wanted.box);
    gone += states.before == PresenceState::Present && states.after == PresenceState::Absent ? 1 : 0;
    there += states.after == PresenceState::Present ? 1 : 0;
  }
  EXPECT_GT(gone, 0U);
  EXPECT_GT(there, 0U);
}

TEST_F(FacadeVisits, PointsAreThoseOfTheTask) {
  const mapping::MapReader reader(map->file());
  const auto expected = tasks::changedPoints(reader, tasks::changesIn(reader, {}, 1));
  const ChangedPoints found = map->changes({.with_points = true}).points;
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_GT(found.size(), 50U);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_EQ(found.cloud_ids.at(found.cloud[i]), expected[i].cloud.hex());
    ASSERT_EQ(found.point[i], expected[i].point);
    ASSERT_EQ(found.change[i], expected[i].change);
    ASSERT_EQ(found.is_gone[i] != 0, expected[i].is_gone);
  }
  EXPECT_EQ(std::set<std::string>(found.cloud_ids.begin(), found.cloud_ids.end()).size(), found.cloud_ids.size());
}

TEST_F(FacadeVisits, TimesAreNumbersOrTexts) {
  std::vector<double> times_s;
  for (const Cloud& cloud : map->clouds()) times_s.push_back(cloud.time_s.value());
  std::sort(times_s.begin(), times_s.end());
  const double since_s = times_s[2] + 0.25, until_s = times_s[5];
  const SiteChanges numbers = map->changes({.since = since_s, .until = until_s}),
                    texts = map->changes({.since = dateTimeText(since_s), .until = dateTimeText(until_s)});
  EXPECT_EQ(numbers.since_s, since_s);
  EXPECT_EQ(numbers.until_s, until_s);
  EXPECT_EQ(texts.since_s, since_s);
  EXPECT_EQ(texts.until_s, until_s);
  EXPECT_EQ(numbers.summary, texts.summary);
  EXPECT_EQ(numbers.changes.size(), texts.changes.size());
}

TEST_F(FacadeVisits, TimesThatTellNothingAreRefused) {
  const auto refusalOf = [](VisitOptions options, const Map& of) {
    try {
      of.changes(options);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(refusalOf({.since = "yesterday"}, *map), ::testing::HasSubstr("'yesterday' is no time"));
  EXPECT_THAT(refusalOf({.since = std::nan("")}, *map), ::testing::HasSubstr("is no time"));
  EXPECT_THAT(refusalOf({.since = 1e9}, *map), ::testing::HasSubstr("lies before"));
  EXPECT_THAT(refusalOf({.since = 2e9}, *map), ::testing::HasSubstr("lies at or after"));
  EXPECT_THAT(refusalOf({.since = 2e9, .until = 1.9e9}, *map), ::testing::HasSubstr("which is earlier"));
  EXPECT_THAT(refusalOf({}, FacadeCampus::shared().map), ::testing::HasSubstr("has a time and a pose"));
}

}  // namespace
}  // namespace cluxel
