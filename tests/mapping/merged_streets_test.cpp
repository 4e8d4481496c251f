// SPDX-License-Identifier: Apache-2.0
// Maps of stretches of a street are merged: only what lies around the border is computed and decided, and the merged
// map has the bytes of a build, in the tables of all stages and layers, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "mapping/build/map_update.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

/// The blocks of all tables about tiles and objects.
std::map<std::string, std::string> blocksOf(const fs::path& file) {
  std::map<std::string, std::string> blocks;
  const auto environment = rdf::Environment::open(file, rdf::OpenMode::ReadOnly);
  const rdf::ReadTransaction transaction = environment->read();
  for (const std::string_view table :
       {tables::kPoints, tables::kCluxels, tables::kGround, tables::kFeatures, tables::kLabels, tables::kSummaries,
        tables::kEven, tables::kComponents, tables::kContacts, tables::kSurfaces, tables::kWays, tables::kTileLayers,
        tables::kObjects, tables::kWideTiles, tables::kPresence, tables::kPassedRays})
    transaction.forEachBlock(table, "", [&](std::string_view key, std::string_view bytes) {
      blocks[std::string(table) + "/" + std::string(key)] = std::string(bytes);
    });
  return blocks;
}

/// How many tiles a stage computed.
class ComputedTiles : public ProgressSink {
 public:
  void progress(std::string_view stage, std::size_t done, std::size_t total) override {
    if (done == total) tiles[std::string(stage)] += total;
  }
  std::map<std::string, std::size_t> tiles;
};

enum class Times { Known, Unknown };

/// Scans along a street, from west to east.
class Street {
 public:
  explicit Street(std::uint32_t seed = 8, Times times = Times::Known, double stops = 12)
      : campus_({.seed = seed, .stops = stops, .size_m = 25.0 * stops, .points_per_stop = 7000, .max_range_m = 16}) {
    const ScanSet all = scansOf(campus_.files());
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), 0);
    const auto x_of = [&](std::size_t i) { return all.file(i).T_map_sensor.translation().x(); };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x_of(a) < x_of(b); });
    for (const std::size_t i : order) {
      manifests_.push_back(folder_.path() / ("scan" + std::to_string(manifests_.size()) + ".yaml"));
      std::ofstream text(manifests_.back());
      text << "scans:\n  - {path: " << campus_.files()[i].string();
      if (times == Times::Known) text << ", time_s: " << 1600000000 + 1000 * i;
      text << "}\n";
    }
  }
  std::size_t size() const { return manifests_.size(); }
  ScanSet scans(std::size_t first, std::size_t end) const {
    return scansOf({manifests_.begin() + static_cast<std::ptrdiff_t>(first),
                    manifests_.begin() + static_cast<std::ptrdiff_t>(end)});
  }
  fs::path built(std::size_t first, std::size_t end, const std::string& name,
                 const MapInputs& inputs = shippedInputs()) const {
    fs::remove(folder_.path() / name);
    buildMap(scans(first, end), inputs, folder_.path() / name, {}, silence());
    return folder_.path() / name;
  }
  fs::path builtOf(const std::set<std::size_t>& scans, const std::string& name) const {
    std::vector<fs::path> files;
    for (const std::size_t i : scans) files.push_back(manifests_[i]);
    fs::remove(folder_.path() / name);
    buildMap(scansOf(files), shippedInputs(), folder_.path() / name, {}, silence());
    return folder_.path() / name;
  }
  fs::path merged() const { return folder_.path() / "merged"; }

 private:
  SmallCampus campus_;
  ScratchFolder folder_;
  std::vector<fs::path> manifests_;
};

std::size_t tilesOf(const fs::path& map) {
  return storedTiles(MapReader(map).transaction()).size();
}

TEST(MergeOfStreets, TakesTilesThatOnlyOneMapHas) {
  const Street street;
  const fs::path whole = street.built(0, street.size(), "whole");
  MergeParams params;
  params.force = true;
  // The last pair shares a scan.
  for (const auto& [end, first] : {std::pair<std::size_t, std::size_t>{6, 6}, {4, 4}, {9, 9}, {7, 6}}) {
    const fs::path west = street.built(0, end, "west"), east = street.built(first, street.size(), "east");
    ComputedTiles computed;
    mergeMaps({{west}, {east}}, street.merged(), params, computed);
    EXPECT_TRUE(canonicalText(street.merged()) == canonicalText(whole)) << end;
    EXPECT_TRUE(blocksOf(street.merged()) == blocksOf(whole)) << end;
    EXPECT_LT(3 * computed.tiles["cluxels"], 2 * tilesOf(street.merged())) << end;
  }
}

TEST(ExtensionOfStreets, ReadsAsFarAsLabelsDo) {
  const Street street;
  for (const double halo_m : {0.0, 3.0, 14.0, 16.0}) {
    MapInputs inputs = shippedInputs();
    inputs.params.labelling.halo_m = halo_m;
    const fs::path whole = street.built(0, street.size(), "whole", inputs);
    const fs::path extended = street.built(0, street.size() - 1, "extended", inputs);
    extendMap(extended, street.scans(street.size() - 1, street.size()), {}, silence());
    EXPECT_TRUE(blocksOf(extended) == blocksOf(whole)) << halo_m;
  }
}

/// Merges maps of these scans in this order, in small windows, and compares the result with a build. Returns how many
/// commits took what a map had decided.
std::size_t mergeAndCompare(const Street& street, const std::vector<std::set<std::size_t>>& parts, unsigned threads) {
  std::vector<MapToMerge> maps;
  std::set<std::size_t> all;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    maps.push_back({street.builtOf(parts[i], "part" + std::to_string(i))});
    all.insert(parts[i].begin(), parts[i].end());
  }
  const fs::path whole = street.builtOf(all, "whole");
  MergeParams params;
  params.force = true;
  params.change.threads = threads;
  params.change.max_window_share = 2;
  const ChangeReport report = mergeMaps(maps, street.merged(), params, silence());
  EXPECT_TRUE(canonicalText(street.merged()) == canonicalText(whole));
  EXPECT_TRUE(blocksOf(street.merged()) == blocksOf(whole));
  EXPECT_EQ(report.scans, all.size());
  return report.local_commits;
}

/// Maps that touch, that share scans, that do not touch, and three in turn, the last of them between the others.
TEST(MergeOfStreets, DecidesAroundTheBorderAlone) {
  using Stretches = std::vector<std::pair<std::size_t, std::size_t>>;
  const Street street;
  const std::size_t all = street.size();
  std::size_t lent = 0;
  for (const Stretches& stretches :
       {Stretches{{0, 6}, {6, all}}, Stretches{{4, all}, {0, 4}}, Stretches{{0, 7}, {6, all}},
        Stretches{{0, 4}, {8, all}}, Stretches{{0, 4}, {8, all}, {4, 8}}, Stretches{{0, 5}, {4, 8}, {7, all}}}) {
    std::vector<std::set<std::size_t>> parts;
    for (const auto& [first, end] : stretches) {
      parts.emplace_back();
      for (std::size_t scan = first; scan < end; ++scan) parts.back().insert(scan);
    }
    SCOPED_TRACE(stretches.back().first);
    lent += mergeAndCompare(street, parts, 1 + lent % 2);
  }
  EXPECT_GE(lent, 7U) << "of 8 maps that were added";
}

TEST(MergeOfStreets, OfAnyPartsIsTheBuildFromAllScans) {
  const bool is_long = std::getenv("CLUXEL_LONG_TESTS") != nullptr;
  std::size_t lent = 0;
  for (std::uint32_t seed = 1; seed <= (is_long ? 100U : 3U); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto below = [&](std::size_t count) { return random() % count; };
    const Street street(20 + seed, seed % 3 == 0 ? Times::Unknown : Times::Known, 6 + static_cast<double>(below(4)));
    std::vector<std::set<std::size_t>> parts(2 + below(2));
    // Stretches of random length; some scans are in another map, too, or in it alone.
    for (std::size_t scan = 0, part = 0; scan < street.size(); ++scan) {
      const std::size_t left = parts.size() - 1 - part;
      if (scan > 0 && left > 0 && below(street.size() / parts.size()) == 0) ++part;
      if (below(8) != 0) parts[part].insert(scan);
      if (below(8) == 0) parts[below(parts.size())].insert(scan);
    }
    std::erase_if(parts, [](const auto& part) { return part.empty(); });
    if (parts.size() < 2) continue;
    std::shuffle(parts.begin(), parts.end(), random);
    lent += mergeAndCompare(street, parts, 1 + seed % 2);
  }
  EXPECT_GT(lent, 0U);
}

}  // namespace
}  // namespace cluxel::mapping
