// SPDX-License-Identifier: Apache-2.0
// Changes that are computed around what changed lead to the map, and to the stored state, of a build from nothing.
#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <map>

#include "mapping/change/map_update.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/far_rays.hpp"
#include "mapping/long_tests.hpp"
#include "mapping/street_changes.hpp"
#include "rdf/map_iris.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

/// Random sequences of changes, each compared with a build from nothing. At least half must be computed around the
/// change, or two fifths in strips: what is about the ground takes the whole map. Where a map grows, every other step
/// does not, so that a quarter must.
void checkSequences(std::uint64_t first_campus, unsigned steps,
                    const std::function<std::string(StreetChanges&, unsigned)>& step, How how = How::Around) {
  const unsigned sequences = isLong() ? 12 : 1;
  if (isLong()) steps = 3 * steps + 2;
  std::size_t computed = 0;
  for (unsigned seed = 1; seed <= sequences; ++seed) {
    const StreetScans scans(first_campus + seed);
    StreetChanges changes(scans, seed, how);
    std::string done;
    for (unsigned i = 0; i < steps; ++i) {
      done += step(changes, i) + ", ";
      changes.expectBuildFromScratch(done + "seed " + std::to_string(seed));
      if (testing::Test::HasFailure()) return;
    }
    computed += changes.computed();
  }
  const unsigned all = sequences * steps;
  EXPECT_GE(computed, how == How::Around     ? all / 2
                      : how == How::InStrips ? all * 2 / 5
                                             : all / 4)
      << "too few changes were computed the way that was asked for";
}

TEST(WindowUpdate, GivesTheMapAndTheStoredStateOfABuild) {
  checkSequences(20, 5, [](StreetChanges& changes, unsigned) { return changes.step(); });
}

TEST(WindowUpdate, AppliesStatementsAsABuildDoes) {
  checkSequences(
      40, 7, [](StreetChanges& changes, unsigned i) { return i % 3 == 2 ? changes.step() : changes.stateSomething(); });
}

TEST(WindowUpdate, AppliesOtherNumbersOfRulesAsABuildDoes) {
  checkSequences(
      60, 8, [](StreetChanges& changes, unsigned i) { return i % 4 == 3 ? changes.step() : changes.changeANumber(); });
}

TEST(WindowUpdate, ComesBackToFormerRulesInStrips) {
  checkSequences(
      100, 6, [](StreetChanges& changes, unsigned) { return changes.changeMore(); }, How::InStrips);
}

TEST(WindowUpdate, DecidesAllInStripsAsABuildDoes) {
  checkSequences(
      80, 6,
      [](StreetChanges& changes, unsigned i) {
        switch (i % 5) {
          case 0:
            return changes.stateSomething();
          case 1:
            return changes.addAClass();
          case 2:
            return changes.step();
          case 3:
            return changes.changeMore();
          default:
            return changes.changeANumber();
        }
      },
      How::InStrips);
}

TEST(WindowUpdate, GrowsInBandsAndStripsAsABuildDoes) {
  checkSequences(
      140, 6,
      [](StreetChanges& changes, unsigned i) {
        if (i % 2 == 0) return changes.grow();
        return i % 4 == 1 ? changes.stateSomething() : changes.step();
      },
      How::Growing);
}

TEST(WindowUpdate, TellsTheSameObjectsInStrips) {
  const StreetScans scans(3, 65);
  for (unsigned seed = 1; seed <= (isLong() ? 6U : 2U); ++seed) {
    const ScratchFolder folder;
    std::mt19937 random(seed);
    std::map<std::size_t, int> there, fresh;
    for (std::size_t scan = 0; scan < scans.size(); ++scan) (random() % 2 == 0 ? there : fresh)[scan] = 0;
    const fs::path at_once = folder.path() / "at_once.clx", in_strips = folder.path() / "in_strips.clx";
    buildMap(scans.at(there, folder.path()), shippedInputs(), at_once, {}, silence());
    fs::copy_file(at_once, in_strips);
    const ScanSet added = scans.at(fresh, folder.path());
    const ChangeReport report = extendMap(in_strips, added, {.max_window_share = 2, .whole_cluxels = 200}, silence());
    EXPECT_EQ(report.local_commits, 1U) << "was decided as a whole";
    EXPECT_GT(report.tiles_decided, report.tiles) << "was not decided in strips";
    EXPECT_EQ(countsOf(report.objects), countsOf(extendMap(at_once, added, {.max_window_share = 2}, silence()).objects))
        << "seed " << seed;
  }
}

TEST(WindowUpdate, DecidesAScatteredChangeWithTheWholeMapInStrips) {
  const StreetScans scans(3, 65);
  const ScratchFolder folder;
  std::map<std::size_t, int> there, fresh;
  for (std::size_t scan = 0; scan < scans.size(); ++scan) (scan == scans.size() / 2 ? fresh : there)[scan] = 0;
  const fs::path around = folder.path() / "around.clx", whole = folder.path() / "whole.clx";
  buildMap(scans.at(there, folder.path()), shippedInputs(), around, {}, silence());
  fs::copy_file(around, whole);
  const ScanSet added = scans.at(fresh, folder.path());
  const ChangeReport of_whole = extendMap(whole, added, {.max_window_share = 0.1, .whole_cluxels = 50}, silence());
  EXPECT_EQ(of_whole.local_commits, 0U) << "strips took tiles from one state to another";
  EXPECT_GT(of_whole.tiles_decided, of_whole.tiles) << "was not decided in strips";
  const ChangeReport of_change = extendMap(around, added, {.max_window_share = 2}, silence());
  EXPECT_EQ(of_change.local_commits, 1U);
  EXPECT_EQ(countsOf(of_whole.objects), countsOf(of_change.objects));
  EXPECT_TRUE(canonicalText(whole) == canonicalText(around));
  EXPECT_THAT(differingTables(whole, around), testing::IsEmpty());
}

TEST(WindowUpdate, TellsWhatRaysPassBeyondTheStrips) {
  const FarRays rays;
  const fs::path map = rays.file("map.clx"), at_once = rays.file("at_once.clx"), fresh = rays.file("fresh.clx");
  buildMap(rays.scans(0, 3), shippedInputs(), map, {}, silence());
  fs::copy_file(map, at_once);
  const ChangeReport report = extendMap(map, rays.scans(3, 6), {.max_window_share = 2, .whole_cluxels = 60}, silence());
  EXPECT_EQ(report.local_commits, 1U) << "was decided as a whole";
  EXPECT_GT(report.tiles_decided,
            extendMap(at_once, rays.scans(3, 6), {.max_window_share = 2}, silence()).tiles_decided)
      << "was not decided in strips";
  buildMap(rays.scans(0, 6), shippedInputs(), fresh, {}, silence());
  EXPECT_TRUE(canonicalText(map) == canonicalText(fresh));
  EXPECT_THAT(differingTables(map, fresh), testing::IsEmpty());
}

/// How many primitives were decided.
class SceneSize : public ProgressSink {
 public:
  void progress(std::string_view stage, std::size_t, std::size_t total) override {
    if (stage == "scene") primitives = total;
  }
  std::size_t primitives = 0;
};

/// The IRI of the westernmost tree.
std::string treeAtTheEnd(const MapReader& reader) {
  std::string tree;
  double west = std::numeric_limits<double>::infinity();
  for (const SemanticObject& object : reader.objects()) {
    if (object.class_iri != vocabulary::clx("Tree")) continue;
    const double x = reader.scene().cluxels.center[object.parts.front().cluxels.front()].x();
    if (x < west) west = x, tree = rdf::iriOfObject(object.id);
  }
  return tree;
}

TEST(WindowUpdate, FollowsStatementsOfASparqlUpdate) {
  const StreetScans scans(33, 300);
  const ScratchFolder folder;
  const fs::path map = folder.path() / "map.clx", stated = folder.path() / "stated.clx";
  std::map<std::size_t, int> all;
  for (std::size_t i = 0; i < scans.size(); ++i) all[i] = 0;
  buildMap(scans.at(all, folder.path()), shippedInputs(), map, {}, silence());
  fs::copy_file(map, stated);
  const std::string tree = treeAtTheEnd(MapReader(map));
  ASSERT_NE(tree, "");
  SceneSize decided;
  updateMap(map, "INSERT DATA { <" + tree + "> a <" + vocabulary::clx("UtilityPole") + "> }", {}, decided,
            {.author = "anna", .layers = {.max_window_share = 2}});
  EXPECT_GT(decided.primitives, 0U);
  EXPECT_LT(decided.primitives, MapReader(map).scene().primitives.size()) << "the whole map was decided";
  EXPECT_EQ(knownStatements(MapReader(map).quads()).front().author, "anna");
  StatementEdit edit;
  edit.added = storedStatements(MapReader(map).quads());
  ASSERT_EQ(edit.added.size(), 1U);
  changeStatements(stated, edit, {.max_window_share = 0}, silence());
  EXPECT_TRUE(canonicalText(map) == canonicalText(stated));
  EXPECT_THAT(differingTables(map, stated), testing::IsEmpty());
  const std::string derived =
      "PREFIX prov: <http://www.w3.org/ns/prov#> ASK { GRAPH <https://w3id.org/cluxel/graph/history> { ?new "
      "prov:wasDerivedFrom <" +
      tree + "> ; prov:wasGeneratedBy ?run } }";
  EXPECT_TRUE(sparql::evaluateQuery(MapReader(map).quads(), derived).boolean) << "by the run of the update";
}

TEST(WindowUpdate, TakesTheGroundOfAnAreaThatLosesItsOnlyScan) {
  const StreetScans scans(31);
  const ScratchFolder folder;
  const fs::path map = folder.path() / "map.clx", fresh = folder.path() / "fresh.clx";
  const std::size_t alone = scans.size() - 1;  // some 110 m from the others
  buildMap(scans.at({{0, 0}, {1, 0}, {2, 0}, {alone, 0}}, folder.path()), shippedInputs(), map, {}, silence());
  retractScans(map, {scans.idOf(alone)}, {.max_window_share = 2}, silence());
  buildMap(scans.at({{0, 0}, {1, 0}, {2, 0}}, folder.path()), shippedInputs(), fresh, {}, silence());
  EXPECT_TRUE(canonicalText(map) == canonicalText(fresh));
  EXPECT_THAT(differingTables(map, fresh), testing::IsEmpty());
}

}  // namespace
}  // namespace cluxel::mapping
