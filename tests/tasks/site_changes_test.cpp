// SPDX-License-Identifier: Apache-2.0
// What changed between two visits to a generated campus, against the truth of its events.
#include "tasks/changes/site_changes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/file_bytes.hpp"
#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/vocabulary.hpp"
#include "scan/formats/scan_writer.hpp"
#include "simulation/laser/campus_writer.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/ask/task_table.hpp"
#include "tasks/changes/changed_points.hpp"
#include "tasks/view/view_page.hpp"
#include "tasks/view/view_values.hpp"
#include "tasks/ways/route.hpp"

namespace cluxel::tasks {
namespace {

namespace fs = std::filesystem;
using mapping::silence;

struct TrueEvent {
  bool is_new = false;
  std::string kind;
  Eigen::Vector3d centre;
  int points = 0;  ///< that the visit with less of them measures there
};

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  cells.resize(21);
  return cells;
}

void keepFirstLines(const fs::path& file, std::size_t count) {
  std::ifstream in(file);
  std::string kept, line;
  while (count > 0 && std::getline(in, line)) {
    kept += line + "\n";
    if (!line.starts_with('#')) --count;
  }
  in.close();
  std::ofstream(file) << kept;
}

class SiteChangesTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new rdf::ScratchFolder();
    simulation::CampusParams params{.seed = 51, .stops = 4, .size_m = 50, .points_per_stop = 60'000};
    params.visits = 2;
    params.pose_error_m = 0.03;
    writeCampus(buildCampus(params), scans(), 2, silence());
    build(scans(), mapFile());
    map = new mapping::MapReader(mapFile());
    found = new SiteChanges(changesIn(*map, {}, 1));
  }
  static void TearDownTestSuite() {
    delete found;
    delete map;
    delete folder;
  }

  static fs::path scans() { return folder->path() / "scans"; }
  static fs::path mapFile() { return folder->path() / "map.clx"; }
  static void build(const fs::path& from, const fs::path& to) {
    buildMap(scan::ScanSet::open({from}, {}, silence()), mapping::shippedInputs(), to, {}, silence());
  }

  /// Events of which both visits measure 60 points or more.
  static std::vector<TrueEvent> clearEvents() {
    std::ifstream file(scans() / "truth" / "events.csv");
    std::vector<TrueEvent> events;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
      const auto cells = cellsOf(line);
      for (const bool is_new : {false, true}) {
        const std::size_t box = is_new ? 11 : 5, points = is_new ? 19 : 17;
        if (cells[box].empty()) continue;
        TrueEvent event{is_new, cells[1], {}, std::min(std::stoi(cells[points]), std::stoi(cells[points + 1]))};
        for (std::size_t axis = 0; axis < 3; ++axis)
          event.centre[static_cast<Eigen::Index>(axis)] =
              0.5 * (std::stod(cells[box + axis]) + std::stod(cells[box + 3 + axis]));
        if (event.points >= 60) events.push_back(event);
      }
    }
    return events;
  }

  /// Boxes of what vanished and what appeared.
  static std::vector<std::pair<bool, Eigen::AlignedBox3d>> reported(const SiteChanges& changes) {
    std::vector<std::pair<bool, Eigen::AlignedBox3d>> boxes;
    for (const SiteChange& change : changes.changes) {
      boxes.emplace_back(change.kind == SiteChange::Kind::Appeared, change.thing.box);
      if (change.now) boxes.emplace_back(true, change.now->box);
    }
    return boxes;
  }

  static inline rdf::ScratchFolder* folder = nullptr;
  static inline mapping::MapReader* map = nullptr;
  static inline SiteChanges* found = nullptr;
};

TEST_F(SiteChangesTest, FindsWhatLeftArrivedAndMoved) {
  std::size_t count = 0;
  for (const TrueEvent& event : clearEvents()) {
    if (event.kind == "replaced" || event.kind == "cut") continue;
    ++count;
    const auto boxes = reported(*found);
    EXPECT_TRUE(std::any_of(
        boxes.begin(), boxes.end(),
        [&](const auto& box) { return box.first == event.is_new && box.second.exteriorDistance(event.centre) < 0.5; }))
        << event.kind << " at " << event.centre.transpose();
  }
  EXPECT_GE(count, 4);
}

TEST_F(SiteChangesTest, HasThePointsOfWhatChanged) {
  const std::vector<ChangedPoint> points = changedPoints(*map, *found, 2000);
  std::set<std::uint32_t> with_points;
  std::map<scan::ScanId, mapping::PointAnswers> answers;
  std::map<scan::ScanId, scan::Scan> scan_of;
  for (const mapping::Cloud& cloud : map->clouds())
    answers[cloud.id] = map->answersFor(cloud), scan_of[cloud.id] = map->scanOf(cloud.id);
  for (const ChangedPoint& point : points) {
    const SiteChange& change = found->changes[*with_points.insert(point.change).first];
    const ChangedThing& thing = change.now && !point.is_gone ? *change.now : change.thing;
    EXPECT_EQ(point.is_gone, *scan_of.at(point.cloud).time_s < found->times.since_s);
    const std::uint32_t cluxel = answers.at(point.cloud).cluxel.at(point.point);
    EXPECT_TRUE(std::binary_search(thing.cluxels.begin(), thing.cluxels.end(), cluxel));
  }
  EXPECT_EQ(with_points.size(), found->changes.size());
  std::set<std::pair<scan::ScanId, std::uint32_t>> once, of_few_regions;
  for (const ChangedPoint& point : points) EXPECT_TRUE(once.emplace(point.cloud, point.point).second);
  for (const ChangedPoint& point : changedPoints(*map, *found)) of_few_regions.emplace(point.cloud, point.point);
  EXPECT_EQ(once, of_few_regions);
}

TEST_F(SiteChangesTest, PartsAreThingsOfWhichTheWholeIsNotAbsent) {
  for (const PartStates& states : statesOfParts(*found)) EXPECT_TRUE(states.part->is_part);
  for (const SiteChange& change : found->changes)
    EXPECT_TRUE(!change.now || !change.thing.object || change.thing.object != change.now->object);
}

TEST_F(SiteChangesTest, TheTaskAnswersWithTheChangesAndTheirPlaces) {
  const std::vector<Task> tasks = tasksOf({});
  const Task& task = taskNamed(tasks, "changes");
  const TaskAnswer plain = task.run({*map, false, {}}, TaskValues(task.parameters, {}));
  ASSERT_EQ(plain.rows.size(), found->changes.size());
  for (std::size_t i = 0; i < plain.rows.size(); ++i) {
    const SiteChange& change = found->changes[i];
    const TaskRow& row = plain.rows[i];
    ASSERT_EQ(row.cells.size(), task.columns.size());
    EXPECT_EQ(std::get<std::string>(row.cells[0]), nameOf(change.kind));
    EXPECT_EQ(std::holds_alternative<std::string>(row.cells[1]), change.thing.object.has_value());
    EXPECT_EQ(row.shape.places.size(), change.now ? 2U : 1U);
    const Eigen::Vector2d from = change.thing.box.center().head<2>();
    EXPECT_EQ(row.shape.places.front(), from);
    if (!change.now) continue;
    EXPECT_NEAR((row.shape.places[1] - from).norm(), std::get<double>(row.cells[7]), 1.0);
  }
  const TaskAnswer all =
      task.run({*map, true, {}},
               TaskValues(task.parameters, {{"unobserved", "true"}, {"since", std::to_string(found->times.since_s)}}));
  const auto unseen = std::count_if(found->states.begin(), found->states.end(), [](const ObjectStates& states) {
    return states.after == perception::PresenceState::NotObserved;
  });
  EXPECT_GT(unseen, 0);
  EXPECT_EQ(all.rows.size(), plain.rows.size() + static_cast<std::size_t>(unseen));
  for (std::size_t i = plain.rows.size(); i < all.rows.size(); ++i) EXPECT_FALSE(all.rows[i].why.empty());
}

TEST_F(SiteChangesTest, ThePageHoldsTheChangesOfEachLaterVisit) {
  std::string page;
  writeViewPage(*map, "<html><!--map data--></html>", {}, {.name = "m", .reasons = false},
                [&](std::string_view piece) { page.append(piece); });
  EXPECT_NE(page.find("id=\"changes\""), std::string::npos);
  const auto visits = visitsOf(map->clouds());
  ASSERT_EQ(visits.size(), 2U);
  auto shown = nlohmann::json::parse(visitChangesJson(*map, 2));
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_EQ(shown[0].at("until"), dateTimeText(visits[1].end_s));
  shown[0].erase("until");
  EXPECT_TRUE(shown[0] == nlohmann::json::parse(changesJson(*map, *found))) << "what the last visit changed";
}

TEST_F(SiteChangesTest, VisitsThatChangePlacesChangeTheSigns) {
  // The later visit becomes the earlier one: what vanished has appeared.
  const fs::path swapped = folder->path() / "swapped";
  fs::copy(scans(), swapped, fs::copy_options::recursive);
  std::vector<double> times_s;
  for (int i = 0; i < 8; ++i) times_s.push_back(1.7e9 + 60 * i + (i < 4 ? 86400 : 0));
  scan::writeTimes(times_s, swapped / "times.txt");
  build(swapped, folder->path() / "swapped.clx");
  const mapping::MapReader other(folder->path() / "swapped.clx");
  const SiteChanges changes = changesIn(other, {}, 2);
  const auto before = reported(*found), after = reported(changes);
  ASSERT_EQ(before.size(), after.size());
  std::multiset<std::pair<bool, double>> expected, got;
  for (const auto& [is_new, box] : before) expected.emplace(!is_new, box.volume());
  for (const auto& [is_new, box] : after) got.emplace(is_new, box.volume());
  EXPECT_EQ(got, expected);
}

TEST_F(SiteChangesTest, TheAnswerDoesNotDependOnHowTheMapIsCutIntoRegions) {
  const std::string whole = changesJson(*map, *found);
  ASSERT_FALSE(found->changes.empty());
  for (const std::size_t max_cluxels : {std::size_t{1}, std::size_t{3000}, std::size_t{12'000}})
    EXPECT_EQ(changesJson(*map, changesIn(*map, {}, 2, max_cluxels)), whole) << max_cluxels;
}

TEST_F(SiteChangesTest, ChangesAcrossTheBordersOfRegionsStayWhole) {
  const auto crosses = [](const Eigen::AlignedBox3d& box) {
    return perception::TileGrid().tileOf(box.min()) != perception::TileGrid().tileOf(box.max());
  };
  std::size_t across = 0;
  for (const auto& [is_new, box] : reported(changesIn(*map, {}, 1, 1))) across += crosses(box) ? 1 : 0;
  EXPECT_GE(across, 1) << "the campus has no change that lies in two tiles";
}

TEST_F(SiteChangesTest, MostThingsAreThereBeforeAndAfter) {
  std::size_t stable = 0;
  for (const ObjectStates& states : found->states)
    stable += states.before == perception::PresenceState::Present && states.after == perception::PresenceState::Present;
  EXPECT_GT(2 * stable, found->states.size());
}

TEST_F(SiteChangesTest, AbsentObjectsSayInRdfWhenTheyWereSeenThrough) {
  const std::string query =
      "PREFIX clx: <https://w3id.org/cluxel/ontology#> "
      "SELECT ?o ?last ?through WHERE { ?o clx:lastSeen ?last ; clx:seenThrough ?through FILTER(?through > ?last) }";
  const sparql::ResultTable table = sparql::PreparedQuery(map->quads(), query, {}).evaluate().table;
  std::set<std::string> gone;
  for (std::size_t row = 0; row < table.row_count; ++row) gone.insert(table.at(row, 0)->text);
  std::size_t absent = 0;
  for (const ObjectStates& states : found->states) {
    if (states.before != perception::PresenceState::Present || states.after != perception::PresenceState::Absent)
      continue;
    ++absent;
    EXPECT_EQ(gone.count("https://w3id.org/cluxel/map/object/" + map->objects()[states.object].id.hex()), 1);
  }
  EXPECT_GE(absent, 1);
}

TEST_F(SiteChangesTest, WhatIsGoneClosesNoWay) {
  WayRequest with_gone;
  with_gone.with_gone = true;
  const PassableGrid now = passableIn(*map, {}), ever = passableIn(*map, with_gone);
  std::set<std::uint32_t> gone;
  for (const ObjectStates& states : found->states)
    if (states.after == perception::PresenceState::Absent) gone.insert(states.object);
  std::size_t opened = 0;
  for (std::uint32_t cell = 0; cell < now.closure.size(); ++cell) {
    if (now.closure[cell] == Closure::Obstacle) {
      EXPECT_EQ(ever.closure[cell], Closure::Obstacle);
      EXPECT_EQ(gone.count(now.blocker[cell]), 0);
    }
    opened += now.closure[cell] != Closure::Obstacle && ever.closure[cell] == Closure::Obstacle ? 1 : 0;
  }
  EXPECT_GT(opened, 3);
}

TEST_F(SiteChangesTest, ExtendingByTheSecondVisitGivesTheMapOfBoth) {
  const fs::path first = folder->path() / "first", grown = folder->path() / "grown.clx";
  fs::copy(scans(), first, fs::copy_options::recursive);
  for (int i = 4; i < 8; ++i) fs::remove(first / ("scan_00" + std::to_string(i) + ".pcd"));
  keepFirstLines(first / "poses.txt", 4);
  keepFirstLines(first / "times.txt", 4);
  build(first, grown);
  mapping::extendMap(grown, scan::ScanSet::open({scans()}, {}, silence()), {}, silence());
  EXPECT_EQ(mapping::canonicalText(grown), mapping::canonicalText(mapFile()));
}

TEST_F(SiteChangesTest, OneLaterScanDoesNotTakeCrownsApart) {
  simulation::CampusParams params{.seed = 51, .stops = 4, .size_m = 50, .points_per_stop = 60'000};
  params.visits = 2;
  params.later_stops = 1;
  writeCampus(buildCampus(params), folder->path() / "few", 2, silence());
  build(folder->path() / "few", folder->path() / "few.clx");
  const mapping::MapReader few(folder->path() / "few.clx");
  std::size_t crowns = 0;
  const SiteChanges seen = changesIn(few, {}, 1);
  for (const ObjectStates& states : seen.states)
    crowns += few.objects()[states.object].class_iri == rdf::vocabulary::clx("Tree") ? 1 : 0;
  EXPECT_GE(crowns, 3) << "the test needs trees";
  for (const SiteChange& change : seen.changes) {
    if (!change.thing.object) continue;
    EXPECT_NE(few.objects()[*change.thing.object].class_iri, rdf::vocabulary::clx("Tree")) << nameOf(few, change.thing);
  }
}

TEST(StatesOfParts, AreThoseThatTheWholeDoesNotTell) {
  using perception::PresenceState;
  const auto thing = [](std::optional<std::uint32_t> object) {
    return ChangedThing{{1, 2}, object, true, {}, {}, false};
  };
  SiteChanges changes;
  changes.states = {{0, PresenceState::Present, PresenceState::Present},
                    {1, PresenceState::Present, PresenceState::Absent},
                    {2, PresenceState::Absent, PresenceState::Present}};
  changes.changes = {{SiteChange::Kind::Vanished, thing(0), std::nullopt, 0},
                     {SiteChange::Kind::Vanished, thing(1), std::nullopt, 0},
                     {SiteChange::Kind::Vanished, thing(std::nullopt), std::nullopt, 0},
                     {SiteChange::Kind::Appeared, thing(2), std::nullopt, 0},
                     {SiteChange::Kind::Moved, thing(1), thing(0), 2}};
  const std::vector<PartStates> parts = statesOfParts(changes);
  ASSERT_EQ(parts.size(), 2);
  EXPECT_EQ(parts[0].part, &changes.changes[0].thing);
  EXPECT_EQ(parts[0].before, PresenceState::Present);
  EXPECT_EQ(parts[0].after, PresenceState::Absent);
  EXPECT_EQ(parts[1].part, &*changes.changes[4].now);
  EXPECT_EQ(parts[1].before, PresenceState::Absent);
  EXPECT_EQ(parts[1].after, PresenceState::Present);
}

TEST_F(SiteChangesTest, RefusesOneSidedTimes) {
  const auto message = [&](double since_s) {
    try {
      changesIn(*map, {since_s}, 1);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(message(1.6e9), ::testing::HasSubstr("no cloud with time and pose lies before"));
  EXPECT_THAT(message(1.8e9), ::testing::HasSubstr("no cloud with time and pose lies at or after"));
  EXPECT_EQ(visitsOf(map->clouds()).size(), 2);
}

}  // namespace
}  // namespace cluxel::tasks
