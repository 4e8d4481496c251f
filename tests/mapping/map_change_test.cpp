// SPDX-License-Identifier: Apache-2.0
// Extending, retracting, moving and re-deciding give the map of a build from scratch, byte for byte.
#include "mapping/change/map_change.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <map>
#include <random>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/facts/map_history.hpp"
#include "mapping/long_tests.hpp"
#include "mapping/map_change_fixture.hpp"
#include "mapping/presence/stored_presence.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST_F(MapChange, ExtendingOneByOneInAnyOrderGivesTheBuildFromScratch) {
  std::mt19937 random(1);
  std::vector<std::size_t> order{0, 1, 2, 3};
  const unsigned rounds = isLong() ? 40 : 4;  // 20 orders, with 1 and 2 threads
  for (unsigned round = 0; round < rounds; ++round) {
    if (round % 2 == 0) std::shuffle(order.begin(), order.end(), random);
    build({{order[0], 0}});
    Poses there{{order[0], 0}};
    for (std::size_t i = 1; i < order.size(); ++i) {
      const ChangeReport report = extend(order[i], 0, {.threads = 1 + round % 2});
      there[order[i]] = 0;
      EXPECT_EQ(report.scans_added, 1U);
      EXPECT_EQ(report.scans, there.size());
      EXPECT_GE(report.tiles_changed, report.tiles_touched);
      expectExact(there);
    }
  }
}

TEST_F(MapChange, ExtendingPassesOverWhatIsThere) {
  build({{0, 0}, {1, 0}});
  const ChangeReport report = extendMap(map(), posed({{0, 0}, {1, 0}, {2, 0}}), {.batch_points = 1}, silence());
  EXPECT_EQ(report.scans_added, 1U);
  EXPECT_EQ(report.scans_already_there, 2U);
  expectExact({{0, 0}, {1, 0}, {2, 0}});
}

TEST_F(MapChange, RetractingAScanLeavesNoTraceOfIt) {
  build({{0, 0}, {1, 0}, {2, 0}});
  for (const unsigned threads : {1U, 2U}) {
    EXPECT_EQ(retract(1, {.threads = threads}).scans_removed, 1U);
    expectExact({{0, 0}, {2, 0}});
    extend(1, 0, {.threads = threads});
    expectExact({{0, 0}, {1, 0}, {2, 0}});
  }
}

/// Its bounds hold 10^11 tiles.
TEST_F(MapChange, AScanWithAPointFarAwayCanBeRetracted) {
  const auto write = [&](const std::string& name, double height_m, const std::string& last) {
    const fs::path path = folder.path() / name;
    std::ofstream text(path);
    for (int i = 0; i < 400; ++i) text << 0.1 * (i % 20) << ' ' << 0.1 * (i / 20) << ' ' << height_m << '\n';
    text << last;
    return path;
  };
  const fs::path near = write("near.xyz", 0, ""), far = write("far.xyz", 0.1, "9000000 9000000 0\n");
  buildMap(scansOf({near}), *inputs, folder.path() / "near.clx", {}, silence());
  buildMap(scansOf({near, far}), *inputs, map(), {.force = true}, silence());
  EXPECT_EQ(retractScans(map(), {scansOf({far}).load(0).id}, {}, silence()).scans_removed, 1U);
  EXPECT_TRUE(contentOf(map()) == contentOf(folder.path() / "near.clx"));
}

TEST_F(MapChange, MovedScansGiveTheBuildWithTheirNewPoses) {
  build({{0, 0}, {1, 0}, {2, 0}, {3, 0}});
  for (const unsigned threads : {1U, 2U}) {
    EXPECT_EQ(move({{1, 1}, {3, -1}}, {.threads = threads}).scans_moved, 2U);
    expectExact({{0, 0}, {1, 1}, {2, 0}, {3, -1}});
    move({{1, 0}, {3, 0}}, {.threads = threads});
    expectExact({{0, 0}, {1, 0}, {2, 0}, {3, 0}});
  }
  EXPECT_EQ(move({{1, 0}}).scans_moved, 0U);
  // All scans see the same place, so that they move at once.
  const std::size_t runs = activitiesIn(MapReader(map()).quads()).size();
  EXPECT_EQ(move({{0, 1}, {1, 1}, {2, 1}, {3, 1}}, {.batch_points = 1}).scans_moved, 4U);
  EXPECT_EQ(activitiesIn(MapReader(map()).quads()).size(), runs + 1);
}

TEST_F(MapChange, ARandomSequenceOfOperationsKeepsTheMapExact) {
  std::mt19937 random(7);
  const auto below = [&random](std::size_t count) { return static_cast<std::size_t>(random() % count); };
  Poses there{{0, 0}};
  build(there);
  for (int step = 0; step < (isLong() ? 50 : 10); ++step) {
    const std::size_t scan = below(kScans);
    const int pose = static_cast<int>(below(3)) - 1;
    if (!there.contains(scan)) {
      extend(scan, pose, {.threads = 1 + static_cast<unsigned>(below(2))});
      there[scan] = pose;
    } else if (there.size() > 1 && below(2) == 0) {
      retract(scan);
      there.erase(scan);
    } else {
      move({{scan, pose}});
      there[scan] = pose;
    }
    ASSERT_TRUE(contentOf(map()) == fromScratch(there)) << "step " << step;
  }
}

TEST_F(MapChange, ADryRunTellsTheChangeAndWritesNothing) {
  build({{0, 0}, {1, 0}});
  const std::string before = readFile(map());
  const ChangeReport dry = extend(2, 0, {.dry_run = true});
  EXPECT_TRUE(readFile(map()) == before);
  const ChangeReport real = extend(2, 0);
  EXPECT_EQ(dry.objects.added, real.objects.added);
  EXPECT_EQ(dry.objects.gone, real.objects.gone);
  EXPECT_EQ(dry.objects.changed.size(), real.objects.changed.size());
  EXPECT_EQ(dry.tiles_changed, real.tiles_changed);
}

TEST_F(MapChange, OperatorStatementsStay) {
  build({{0, 0}, {1, 0}});
  const std::string statement = "<https://example.org/bench7> <http://www.w3.org/2000/01/rdf-schema#label> \"bench\"";
  updateMap(map(), "INSERT DATA { " + statement + " }", {}, silence());
  extend(2, 0);
  retract(0);
  EXPECT_THAT(canonicalText(map()), HasSubstr(statement));
}

TEST_F(MapChange, ALaterTimeOfAKnownScanIsKept) {
  std::ofstream(folder.path() / "later.yaml")
      << "scans:\n  - {path: " << campus->files()[1].string() << ", time_s: 1700000000.5}\n";
  const ScanSet again = scansOf({folder.path() / "later.yaml"});
  ASSERT_EQ(again.load(0).id, ids[1]);
  std::ofstream(folder.path() / "both.yaml")
      << "scans:\n  - {path: " << campus->files()[0].string()
      << ", time_s: 1600000000}\n  - {path: " << campus->files()[1].string() << ", time_s: 1700000000.5}\n";
  const ScanSet both = scansOf({folder.path() / "both.yaml"});
  buildMap(both, *inputs, folder.path() / "other.clx", {}, silence());
  for (const std::uint64_t cluxels : {UpdateParams{}.whole_cluxels, std::uint64_t{10}}) {
    build({{0, 0}, {1, 0}});
    const ChangeReport report = extendMap(map(), again, {.whole_cluxels = cluxels}, silence());
    EXPECT_EQ(report.scans_already_there, 1U);
    EXPECT_TRUE(report.has_changes);
    EXPECT_TRUE(canonicalText(map()) == canonicalText(folder.path() / "other.clx")) << cluxels;
  }
}

TEST_F(MapChange, LineageLeadsFromCommitToCommit) {
  build({{0, 0}});
  extendMap(map(), posed({{1, 0}, {2, 0}}), {.threads = 1, .batch_points = 1}, silence());
  const MapReader reader(map());
  const auto origins = sparql::evaluateQuery(reader.quads(), R"(PREFIX prov: <http://www.w3.org/ns/prov#>
    ASK { GRAPH <https://w3id.org/cluxel/graph/history> { ?a prov:wasDerivedFrom ?b . ?b prov:wasDerivedFrom ?c } })");
  EXPECT_TRUE(origins.boolean) << "an object that changed twice has two steps";
  const auto gone = sparql::evaluateQuery(
      reader.quads(), R"(PREFIX prov: <http://www.w3.org/ns/prov#> PREFIX clx: <https://w3id.org/cluxel/ontology#>
    ASK { GRAPH <https://w3id.org/cluxel/graph/history> { ?a prov:wasInvalidatedBy ?x, ?y FILTER(?x != ?y) } })");
  EXPECT_FALSE(gone.boolean) << "an object goes once";
}

TEST_F(MapChange, PresenceIsComputedOnlyWhereRaysOrObjectsDiffer) {
  build({{0, 0}, {1, 0}, {2, 0}, {3, 0}});
  const MapReader map(this->map());
  const auto environment = Environment::open(this->map(), OpenMode::ReadWrite);
  WriteTransaction transaction = environment->write();
  std::vector<Cloud> clouds = map.clouds();
  const std::vector<RayTarget> targets = rayTargets(map.scene(), map.objects(), parseInputs(*inputs).rules);
  using Times = std::vector<std::array<std::optional<double>, 4>>;
  const auto update = [&](unsigned threads) {
    PresenceUpdate presence_update(transaction, targets, clouds, threads);
    std::vector<RayObserver*> observers;
    if (presence_update.observer() != nullptr) observers.push_back(presence_update.observer());
    passRays(clouds, observers, [&](const Cloud& cloud) { return map.scanOf(cloud.id); });
    const std::size_t unknown = presence_update.unknownCount();
    Times times;
    for (const auto& presence : presence_update.finish(transaction, Covered::All)) {
      times.emplace_back();
      if (presence)
        times.back() = {presence->first_seen_s, presence->last_seen_s, presence->seen_empty_s,
                        presence->seen_through_s};
    }
    return std::pair(unknown, times);
  };
  const auto [known_unknown, known] = update(1);
  EXPECT_EQ(known_unknown, 0U);
  clouds.front().time_s = 1700000000;
  const auto [changed_unknown, changed] = update(2);
  EXPECT_GT(changed_unknown, 0U);
  eraseRowsBut(transaction, tables::kPresence, {});
  const auto [anew_unknown, anew] = update(1);
  EXPECT_GE(anew_unknown, changed_unknown);
  EXPECT_EQ(changed, anew);
  EXPECT_NE(changed, known);
}

TEST_F(MapChange, WhatCannotBeDoneIsRefusedAndChangesNothing) {
  build({{0, 0}});
  const auto refusal = [](const auto& action) {
    try {
      action();
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal([&] { retract(0); }), HasSubstr("no scan would be left"));
  EXPECT_THAT(refusal([&] { retract(1); }), HasSubstr("has no cloud"));
  EXPECT_THAT(refusal([&] { extend(0, 1); }), HasSubstr("with another pose"));
  EXPECT_THAT(refusal([&] { extendMap(folder.path() / "none.clx", *scans, {}, silence()); }),
              HasSubstr("build it first"));
  EXPECT_THAT(refusal([&] { moveScans(map(), {{ids[0], {}}, {ids[0], {}}}, {}, silence()); }), HasSubstr("twice"));
  expectExact({{0, 0}});
}

}  // namespace
}  // namespace cluxel::mapping
