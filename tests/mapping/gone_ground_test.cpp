// SPDX-License-Identifier: Apache-2.0
// Ways over ground on which a thing stood that is gone are those of a map without its points, and follow when it comes
// back: a changed map is then the one that a build makes from nothing.
#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <numeric>
#include <set>

#include "mapping/build/freed_tiles.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/rdf_loading.hpp"
#include "mapping/facts/told_ways.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/presence/stored_presence.hpp"
#include "tasks/box_visits.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;
using tasks::Box;
using tasks::boxFrom;
using Visits = std::set<std::size_t>;

/// Cars between two walls. One of them, which reaches down to the ground, is there on visits 0 and 2 alone.
class GoneGround : public testing::Test {
 protected:
  static constexpr std::size_t kVisits = 3, kSensors = 3;

  static void SetUpTestSuite() {
    folder = new rdf::ScratchFolder;
    inputs = new MapInputs(shippedInputs());
    const Box north = boxFrom({-15, 10, 0}, {15, 10.5, 5}), south = boxFrom({-15, -12.5, 0}, {15, -12, 5});
    const Box stays = boxFrom({-5, 4, 0.05}, {-0.8, 5.8, 1.5}), stays_too = boxFrom({8.5, 4, 0.05}, {12.7, 5.8, 1.5});
    const std::vector<Box> rest{north, south, stays, stays_too};
    std::vector<Box> all = rest;
    all.push_back(kLeaves);
    const std::vector<Eigen::Vector3d> sensors{{1, -1, 1.8}, {5, 0, 1.8}, {8, 1, 1.8}};
    tasks::writeVisits({{all, sensors}, {rest, sensors}, {all, sensors}}, folder->path() / "with");
    tasks::writeVisits({{rest, sensors, {kLeaves}}, {rest, sensors}}, folder->path() / "without");
    scans = new ScanSet(scansOf({folder->path() / "with"}));
  }
  static void TearDownTestSuite() {
    delete scans, delete inputs, delete folder;
    scans = nullptr, inputs = nullptr, folder = nullptr;  // GoneOnStreets ends in this way, too
    built.clear();
  }

  static ScanSet scansIn(const Visits& visits) {
    std::vector<std::size_t> chosen;
    for (const std::size_t visit : visits)
      for (std::size_t i = 0; i < kSensors; ++i) chosen.push_back(visit * kSensors + i);
    return scans->only(chosen);
  }
  static std::vector<ScanId> idsIn(std::size_t visit) {
    std::vector<ScanId> ids;
    for (std::size_t i = 0; i < kSensors; ++i) ids.push_back(scans->load(visit * kSensors + i).id);
    return ids;
  }
  static fs::path build(const ScanSet& given, const std::string& name, const BuildParams& params = {}) {
    const fs::path map = folder->path() / name;
    fs::remove(map);
    buildMap(given, *inputs, map, params, silence());
    return map;
  }

  /// Facts, and what ways are made from.
  static std::string contentOf(const fs::path& map) {
    std::string content = canonicalText(map);
    const ReadTransaction transaction = Environment::open(map, OpenMode::ReadOnly)->read();
    for (const auto table : {tables::kSurfaces, tables::kWays, tables::kFreed})
      transaction.forEachBlock(
          table, "", [&](std::string_view key, std::string_view bytes) { content.append(key).append(bytes); });
    return content;
  }
  static const std::string& fromScratch(const Visits& visits) {
    const auto [entry, is_new] = built.try_emplace(visits);
    if (is_new) entry->second = contentOf(build(scansIn(visits), "fresh.clx"));
    return entry->second;
  }
  static std::size_t goneIn(const fs::path& map) {
    return objectsSeenThrough(Environment::open(map, OpenMode::ReadOnly)->read()).size();
  }
  static std::size_t freedIn(const fs::path& map) {
    std::size_t tiles = 0;
    const ReadTransaction transaction = Environment::open(map, OpenMode::ReadOnly)->read();
    transaction.forEachBlock(tables::kFreed, "", [&](std::string_view key, std::string_view) {
      tiles += freedTile(transaction, tables::tileOfKey(key)) ? 1 : 0;
    });
    return tiles;
  }
  /// Whether the next change computes only what follows from it. False also for a map without freed tiles.
  static bool areUpToDate(const fs::path& map) {
    rdf::WriteTransaction transaction = Environment::open(map, OpenMode::ReadWrite)->write();
    return freedIn(map) > 0 && copyFreedTiles(transaction, transaction, {}) && storedToldWays(transaction).has_value();
  }
  static double areaOf(const WayGraph& ways) {
    return std::accumulate(ways.regions.begin(), ways.regions.end(), 0.0,
                           [](double sum, const Region& region) { return sum + region.area_m2; });
  }

  inline static const Box kLeaves = boxFrom({2, 4, 0.05}, {6.2, 5.8, 1.5});
  inline static rdf::ScratchFolder* folder = nullptr;
  inline static MapInputs* inputs = nullptr;
  inline static ScanSet* scans = nullptr;
  inline static std::map<Visits, std::string> built;
};

TEST_F(GoneGround, IsThatOfAMapWithoutTheThing) {
  const MapReader with(build(scansIn({0, 1}), "with.clx"));
  const MapReader without(build(scansOf({folder->path() / "without"}), "without.clx"));
  const double free = areaOf(without.ways()), found = areaOf(with.ways()), measured = areaOf(with.measuredWays());
  EXPECT_EQ(areaOf(without.measuredWays()), free);
  EXPECT_LT(measured, free - 1) << "its sides close cells";
  // Cells that points of its foot close are left, where these are in one cluxel with points of the ground.
  EXPECT_NEAR(found, free, 0.2 * (free - measured));
}

TEST_F(GoneGround, IsStoredOnlyWhereSomethingIsGone) {
  EXPECT_EQ(freedIn(build(scansIn({0}), "map.clx")), 0U);
  const fs::path gone = build(scansIn({0, 1}), "map.clx");
  EXPECT_EQ(goneIn(gone), 1U);
  EXPECT_GT(freedIn(gone), 0U);
  const fs::path back = build(scansIn({0, 1, 2}), "map.clx");
  EXPECT_EQ(goneIn(back), 0U);
  EXPECT_EQ(freedIn(back), 0U);
}

TEST_F(GoneGround, FollowsWhatLeavesAndComesBack) {
  // Around the change, and the whole map strip by strip.
  for (const ChangeParams& params : {ChangeParams{.threads = 1, .max_window_share = 2},
                                     ChangeParams{.threads = 2, .max_window_share = 0, .whole_cluxels = 400}}) {
    const unsigned threads = params.threads;
    const fs::path map = build(scansIn({0}), "map.clx");
    const auto expect = [&](const Visits& visits, const ChangeReport& report) {
      EXPECT_TRUE(contentOf(map) == fromScratch(visits)) << threads << " threads";
      if (threads == 1) {
        EXPECT_GT(report.local_commits, 0U);
      }
    };
    expect({0, 1}, extendMap(map, scansIn({1}), params, silence()));
    expect({0, 1, 2}, extendMap(map, scansIn({2}), params, silence()));
    expect({0, 1}, retractScans(map, idsIn(2), params, silence()));
    expect({1}, retractScans(map, idsIn(0), params, silence()));
    expect({1, 2}, extendMap(map, scansIn({2}), params, silence()));
    expect({0, 1, 2}, extendMap(map, scansIn({0}), params, silence()));
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{2}})
      retractScans(map, {idsIn(2)[i]}, params, silence());
    EXPECT_TRUE(contentOf(map) == fromScratch({0, 1})) << threads << " threads";
  }
}

TEST_F(GoneGround, IsTheSameInMergesAndBatches) {
  std::vector<MapToMerge> maps;
  for (const std::size_t visit : {std::size_t{1}, std::size_t{2}, std::size_t{0}}) {
    maps.push_back({build(scansIn({visit}), "visit" + std::to_string(visit) + ".clx")});
    if (maps.size() == 1) continue;
    MergeParams params;
    params.force = true;
    mergeMaps(maps, folder->path() / "merged.clx", params, silence());
    EXPECT_TRUE(contentOf(folder->path() / "merged.clx") ==
                fromScratch(maps.size() == 2 ? Visits{1, 2} : Visits{0, 1, 2}));
  }
  MergeParams params;
  params.force = true;
  mergeMaps({maps[0], maps[2]}, folder->path() / "merged.clx", params, silence());
  EXPECT_TRUE(contentOf(folder->path() / "merged.clx") == fromScratch({0, 1}));
  EXPECT_TRUE(contentOf(build(scansIn({0, 1}), "map.clx", {.threads = 2, .batch_points = 1})) == fromScratch({0, 1}));
}

TEST_F(GoneGround, IsUpToDateAfterMergesUpdatesAndLoads) {
  const fs::path first = build(scansIn({0}), "first.clx"), second = build(scansIn({1}), "second.clx");
  const fs::path map = folder->path() / "merged.clx";
  MergeParams params;
  params.force = true;
  mergeMaps({{first}, {second}}, map, params, silence());
  EXPECT_TRUE(areUpToDate(map)) << "after a merge";

  updateMap(map, "INSERT DATA { <https://e.org/a> <https://e.org/p> 1 }", {}, silence());
  EXPECT_TRUE(areUpToDate(map)) << "after an update";

  const fs::path triples = folder->path() / "more.ttl";
  std::ofstream(triples) << "<https://e.org/b> <https://e.org/p> 2 .\n";
  EXPECT_EQ(loadRdfFiles(map, {triples}, {}, silence()).added, 1U);
  EXPECT_TRUE(areUpToDate(map)) << "after a load";

  extendMap(map, scansIn({2}), {}, silence());
  retractScans(map, idsIn(2), {}, silence());
  EXPECT_TRUE(areUpToDate(map)) << "after other changes";
}

/// Two stretches of a street, side by side. A car has left each of them at its second visit, near the other one.
class GoneOnStreets : public GoneGround {
 protected:
  static void SetUpTestSuite() {
    folder = new rdf::ScratchFolder;
    inputs = new MapInputs(shippedInputs());
    constexpr double kEast_m = 43.9;  // tiles end in the middle of the cars that leave
    const std::vector<Box> stays{boxFrom({-15, 10, 0}, {15, 10.5, 5}), boxFrom({-15, -12.5, 0}, {15, -12, 5}),
                                 boxFrom({-5, 4, 0.05}, {-0.8, 5.8, 1.5}), boxFrom({8.5, 4, 0.05}, {12.7, 5.8, 1.5})};
    for (const bool is_west : {true, false}) {
      const double side = is_west ? -1 : 1;
      const auto placed = [&](const Box& box) {
        const double a = side * (kEast_m + box.min().x()), b = side * (kEast_m + box.max().x());
        return boxFrom({std::min(a, b), box.min().y(), box.min().z()}, {std::max(a, b), box.max().y(), box.max().z()});
      };
      std::vector<Box> rest;
      for (const Box& box : stays) rest.push_back(placed(box));
      std::vector<Box> all = rest;
      all.push_back(placed(kLeaves));
      std::vector<Eigen::Vector3d> sensors;
      for (const Eigen::Vector3d& at : {Eigen::Vector3d(1, -1, 1.8), {5, 0, 1.8}, {8, 1, 1.8}})
        sensors.emplace_back(side * (kEast_m + at.x()), at.y(), at.z());
      tasks::writeVisits({{all, sensors}, {rest, sensors}}, streetOf(is_west));
    }
    whole = contentOf(build(scansOf({streetOf(true), streetOf(false)}), "whole.clx"));
  }
  static fs::path streetOf(bool is_west) { return folder->path() / (is_west ? "west" : "east"); }

  /// Takes the ground out of all freed tiles: they are not those of the map any more. An earlier program, which knows
  /// none, leaves the stamp that they had.
  static void spoil(const fs::path& map, bool renews_stamp) {
    rdf::WriteTransaction transaction = Environment::open(map, OpenMode::ReadWrite)->write();
    std::map<std::string, std::string> others;
    transaction.forEachBlock(tables::kFreed, "", [&](std::string_view key, std::string_view bytes) {
      others.emplace(key, bytes.substr(0, sizeof(ContentHash::bytes)));
    });
    for (const auto& [key, bytes] : others) transaction.putBlock(tables::kFreed, key, bytes);
    if (renews_stamp) keepFreedTiles(transaction);
    transaction.commit();
  }
  inline static std::string whole;  ///< what a build of all scans makes
};

TEST_F(GoneOnStreets, IsTheSameWhereAMapLendsIt) {
  const fs::path merged = folder->path() / "merged.clx";
  MergeParams params;
  params.force = true, params.change.max_window_share = 2;
  for (const bool is_west : {true, false})
    for (const bool is_known : {true, false}) {
      const fs::path base = build(scansOf({streetOf(is_west)}), "base.clx");
      const fs::path lender = build(scansOf({streetOf(!is_west)}), "lender.clx");
      EXPECT_EQ(goneIn(lender), 1U);
      EXPECT_EQ(freedIn(lender), 2U) << "beside the other map, and farther in";
      if (!is_known) spoil(lender, false);
      EXPECT_EQ(mergeMaps({{base}, {lender}}, merged, params, silence()).maps_taken_over, 1U);
      EXPECT_TRUE(contentOf(merged) == whole) << is_west << is_known;
      EXPECT_TRUE(areUpToDate(merged)) << is_west << is_known;
      spoil(lender, true);
      mergeMaps({{base}, {lender}}, merged, params, silence());
      EXPECT_EQ(freedIn(merged), is_known ? 2U : 4U) << "those of a lender are taken as they are";
    }
}

TEST_F(GoneOnStreets, IsTheSameWhereAMapGrowsInStrips) {
  const ScanSet west = scansOf({streetOf(true)});
  for (const bool leaves_later : {false, true}) {
    const fs::path map = build(leaves_later ? west.only({0, 1, 2}) : west, "grown.clx");
    EXPECT_EQ(goneIn(map), leaves_later ? 0U : 1U);
    const ChangeReport report = extendMap(map, scansOf({streetOf(true), streetOf(false)}),
                                          {.max_window_share = 2, .whole_cluxels = 100}, silence());
    EXPECT_EQ(report.local_commits, 1U) << "the map grows: what it had is not decided strip by strip";
    EXPECT_GT(2 * report.tiles_decided, report.tiles) << report.tiles;
    EXPECT_EQ(goneIn(map), 2U);
    EXPECT_TRUE(contentOf(map) == whole) << leaves_later;
  }
}

}  // namespace
}  // namespace cluxel::mapping
