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

#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/far_rays.hpp"
#include "mapping/layers/semantic_state.hpp"
#include "mapping/long_tests.hpp"
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
        tables::kObjects, tables::kWideTiles, tables::kPresence, tables::kPassedRays, tables::kOverruled,
        tables::kStated})
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
enum class Rays { Short, Long /* one of each scan ends beyond the other end of the street */ };

/// A campus once a process: to generate one takes as long as to map it.
const SmallCampus& campusAlong(std::uint32_t seed, double stops) {
  static std::map<std::pair<std::uint32_t, double>, SmallCampus> made;
  const CampusParams params{
      .seed = seed, .stops = stops, .size_m = 25.0 * stops, .points_per_stop = 7000, .max_range_m = 16};
  return made.try_emplace({seed, stops}, params).first->second;
}

/// Scans along a street, from west to east.
class Street {
 public:
  explicit Street(std::uint32_t seed = 8, Times times = Times::Known, double stops = 12, Rays rays = Rays::Short)
      : campus_(campusAlong(seed, stops)) {
    const ScanSet all = scansOf(campus_.files());
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), 0);
    const auto x_of = [&](std::size_t i) { return all.file(i).T_map_sensor.translation().x(); };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x_of(a) < x_of(b); });
    for (const std::size_t i : order) {
      manifests_.push_back(folder_.path() / ("scan" + std::to_string(manifests_.size()) + ".yaml"));
      std::ofstream text(manifests_.back());
      text << "scans:\n  - {path: " << (rays == Rays::Short ? campus_.files()[i] : withLongRay(i)).string();
      if (times == Times::Known) text << ", time_s: " << 1600000000 + 1000 * i;
      text << "}\n";
    }
  }
  /// A copy of the scan in which a ray passes along the street.
  fs::path withLongRay(std::size_t scan) const {
    const auto x_of = [&](std::size_t i) { return campus_.scans()[i].scan.T_map_sensor.translation().x(); };
    double west = x_of(0), east = x_of(0);
    for (std::size_t i = 1; i < campus_.scans().size(); ++i)
      west = std::min(west, x_of(i)), east = std::max(east, x_of(i));
    Eigen::Vector3d end = campus_.scans()[scan].scan.T_map_sensor.translation();
    end.x() = 2 * end.x() < west + east ? east + 30 : west - 30;
    const fs::path file = folder_.path() / campus_.files()[scan].filename();
    writeScanFile(movedWithRay(campus_.scans()[scan].scan, Eigen::Vector3d::Zero(), end), file);
    return file;
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
  fs::path builtOf(const std::set<std::size_t>& scans, const std::string& name,
                   const std::vector<Quad>& statements = {}) const {
    std::vector<fs::path> files;
    for (const std::size_t i : scans) files.push_back(manifests_[i]);
    fs::remove(folder_.path() / name);
    buildMap(scansOf(files), shippedInputs(), folder_.path() / name, {.statements = statements}, silence());
    return folder_.path() / name;
  }
  const std::vector<fs::path>& manifests() const { return manifests_; }
  fs::path merged() const { return folder_.path() / "merged"; }

 private:
  const SmallCampus& campus_;
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
  using Borders = std::vector<std::pair<std::size_t, std::size_t>>;
  // The last pair shares a scan.
  for (const auto& [end, first] : isLong() ? Borders{{6, 6}, {4, 4}, {9, 9}, {7, 6}} : Borders{{9, 9}}) {
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

/// Some statement about an object of the map, or about a region beside a sensor.
Statement someStatement(const MapReader& map, std::mt19937& random) {
  std::vector<const rules::SemanticObject*> things;
  for (const rules::SemanticObject& object : map.objects())
    if (!object.is_class_wide) things.push_back(&object);
  if (things.empty() || random() % 4 == 0) {
    const Eigen::Vector3d at = map.clouds()[random() % map.clouds().size()].T_map_sensor.translation();
    const double x = at.x() - 10, y = at.y() + 2;
    return {StatementKind::IgnoreRegion, "", {}, {}, regionAnchor(map.clouds(), {{x, y}, {x + 25, y}, {x, y + 6}})};
  }
  const PointAnchor anchor = anchorOf(map.stagesWithPoints(), *things[random() % things.size()]);
  switch (random() % 3) {
    case 0:
      return {StatementKind::Is, "", Term::iri(vocabulary::clx("StreetSign")), anchor, {}};
    case 1:
      return {StatementKind::Remove, "", {}, anchor, {}};
    default:
      return {StatementKind::Fact, vocabulary::rdfs("label"), Term::literal("stated"), anchor, {}};
  }
}

struct MergeCase {
  std::vector<std::set<std::size_t>> parts;  ///< the scans of each map, in the order of the merge
  unsigned threads = 1;
  double max_window_share = 2;  ///< so that small maps are decided around the border, too
  std::size_t statements = 0;   ///< in each map
  std::uint64_t whole_cluxels = UpdateParams{}.whole_cluxels;
  std::size_t max_border_tiles = MergeParams{}.max_border_tiles;
};

/// Merges maps and compares the result with a build; long tests, with the other number of threads, too. Returns how
/// many maps were taken over.
std::size_t mergeAndCompare(const Street& street, const MergeCase& what, std::mt19937& random) {
  std::vector<MapToMerge> maps;
  std::set<std::size_t> all;
  std::vector<Quad> statements;
  std::set<ContentHash> stated;
  for (std::size_t i = 0; i < what.parts.size(); ++i) {
    maps.push_back({street.builtOf(what.parts[i], "part" + std::to_string(i))});
    all.insert(what.parts[i].begin(), what.parts[i].end());
    StatementEdit edit;
    {
      const MapReader map(maps.back().file);
      while (edit.added.size() < what.statements) edit.added.push_back(someStatement(map, random));
    }
    if (!edit.added.empty()) changeStatements(maps.back().file, edit, {}, silence());
    for (const Statement& statement : edit.added)
      if (stated.insert(statement.id()).second)
        for (const Quad& quad : quadsOf(statement)) statements.push_back(quad);
  }
  const fs::path whole = street.builtOf(all, "whole", statements);
  MergeParams params;
  params.force = true;
  params.change.max_window_share = what.max_window_share;
  params.change.whole_cluxels = what.whole_cluxels;
  params.max_border_tiles = what.max_border_tiles;
  ChangeReport report;
  for (const unsigned threads : {3 - what.threads, what.threads}) {
    if (threads != what.threads && !isLong()) continue;
    params.change.threads = threads;
    report = mergeMaps(maps, street.merged(), params, silence());
    EXPECT_TRUE(canonicalText(street.merged()) == canonicalText(whole)) << threads << " threads";
    EXPECT_TRUE(blocksOf(street.merged()) == blocksOf(whole)) << threads << " threads";
  }
  const MapReader built(whole), merged(street.merged());
  const auto state = storedSemanticState(built.transaction()).value();
  EXPECT_EQ(report.scans, all.size());
  EXPECT_EQ(report.cluxels, state.cluxels);
  EXPECT_EQ(report.primitives, state.primitives);
  EXPECT_EQ(report.object_count, state.objects);
  EXPECT_EQ(merged.overruled().size(), built.overruled().size());
  return report.maps_taken_over;
}

/// Maps that touch, that share scans, that do not touch, and three in turn, the last of them between the others.
TEST(MergeOfStreets, DecidesAroundTheBorderAlone) {
  using Stretches = std::vector<std::pair<std::size_t, std::size_t>>;
  const Street street;
  const std::size_t all = street.size();
  std::vector<Stretches> cases{{{4, all}, {0, 4}}, {{0, 7}, {6, all}}, {{0, 4}, {8, all}, {4, 8}}};
  if (isLong()) cases.insert(cases.end(), {{{0, 6}, {6, all}}, {{0, 4}, {8, all}}, {{0, 5}, {4, 8}, {7, all}}});
  std::size_t taken = 0;
  for (const Stretches& stretches : cases) {
    std::vector<std::set<std::size_t>> parts;
    for (const auto& [first, end] : stretches) {
      parts.emplace_back();
      for (std::size_t scan = first; scan < end; ++scan) parts.back().insert(scan);
    }
    SCOPED_TRACE(stretches.back().first);
    std::mt19937 random(1);
    taken += mergeAndCompare(street, {.parts = parts, .threads = 1 + static_cast<unsigned>(taken % 2)}, random);
  }
  EXPECT_EQ(taken, isLong() ? 8U : 4U) << "all maps that were added";
}

TEST(MergeOfStreets, AddsAMapWithALongBorderScanByScan) {
  const Street street;
  std::set<std::size_t> west, east;
  for (std::size_t scan = 0; scan < street.size(); ++scan) (scan < 6 ? west : east).insert(scan);
  std::mt19937 random(3);
  const MergeCase merge{.parts = {west, east}, .threads = 2, .statements = 2, .max_border_tiles = 1};
  EXPECT_EQ(mergeAndCompare(street, merge, random), 0U) << "what the other map decided is taken all the same";
}

TEST(MergeOfStreets, OfAnyPartsIsTheBuildFromAllScans) {
  std::size_t taken = 0;
  for (std::uint32_t seed = 1; seed <= (isLong() ? 100U : 4U); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto below = [&](std::size_t count) { return random() % count; };
    const Street street(20 + seed, seed % 3 == 0 ? Times::Unknown : Times::Known, 6 + static_cast<double>(below(4)));
    std::vector<std::set<std::size_t>> parts(2 + below(isLong() ? 3 : 2));
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
    // Some maps turn out to need too large a window: what was taken is given up again.
    MergeCase merge{parts, 1 + seed % 2, seed % 4 == 0 ? 0.3 + 0.1 * static_cast<double>(below(6)) : 2, below(4)};
    if (seed % 4 == 0) merge.whole_cluxels = 100U << below(12);
    if (seed % 7 == 3) merge.max_border_tiles = below(4);
    taken += mergeAndCompare(street, merge, random);
  }
  EXPECT_GT(taken, 0U);
}

TEST(MergeOfStreets, TellsWhatRaysOfTheOtherMapPassBeyondTheWindow) {
  const FarRays rays;
  const fs::path west = rays.file("west.clx"), east = rays.file("east.clx"), merged = rays.file("merged.clx"),
                 whole = rays.file("whole.clx");
  buildMap(rays.scans(0, 3), shippedInputs(), west, {}, silence());
  buildMap(rays.scans(3, 6), shippedInputs(), east, {}, silence());
  buildMap(rays.scans(0, 6), shippedInputs(), whole, {}, silence());
  const ChangeReport report = mergeMaps({{west}, {east}}, merged, {}, silence());
  EXPECT_EQ(report.maps_taken_over, 1U);
  EXPECT_LT(2 * report.tiles_decided, report.tiles) << "objects that rays pass lie in the window";
  EXPECT_TRUE(canonicalText(merged) == canonicalText(whole));
  EXPECT_TRUE(blocksOf(merged) == blocksOf(whole));
}

TEST(MergeOfStreets, TellsWhatRaysOfTheOtherMapPassWithinTheWindow) {
  for (const std::uint32_t seed : isLong() ? std::vector<std::uint32_t>{8, 9} : std::vector<std::uint32_t>{8}) {
    SCOPED_TRACE(seed);
    const Street street(seed, Times::Known, 12, Rays::Long);
    std::set<std::size_t> west, east;
    for (std::size_t scan = 0; scan < street.size(); ++scan) (2 * scan < street.size() ? west : east).insert(scan);
    std::mt19937 random(seed);
    EXPECT_EQ(mergeAndCompare(street, {.parts = {west, east}}, random), 1U);
  }
}

/// A wall on level ground, far from the street.
scan::Scan farWall() {
  scan::Scan scan;
  scan.T_map_sensor.translation() = Eigen::Vector3d(3000, 0, 1.5);
  scan.has_pose = true;
  const auto add = [&](const Eigen::Vector3f& point) {
    scan.points.x.push_back(point.x()), scan.points.y.push_back(point.y()), scan.points.z.push_back(point.z());
  };
  for (int i = 0; i < 120; ++i)
    for (int j = 0; j < 60; ++j) {
      const float along = -6.0F + 0.1F * static_cast<float>(i), other = 0.1F * static_cast<float>(j);
      add({along, 2 + other, -1.5F});
      add({along, 8.0F, -1.5F + other});
    }
  return scan;
}

TEST(MergeOfStreets, TakesOverAMapFarAway) {
  const Street street(8, Times::Unknown);
  const ScratchFolder folder;
  const fs::path file = folder.path() / "wall.pcd", wall = folder.path() / "wall", whole = folder.path() / "whole";
  writeScanFile(farWall(), file);
  buildMap(scansOf({file}), shippedInputs(), wall, {}, silence());
  std::vector<fs::path> all = street.manifests();
  all.push_back(file);
  buildMap(scansOf(all), shippedInputs(), whole, {}, silence());
  const ChangeReport report =
      mergeMaps({{street.built(0, street.size(), "street")}, {wall}}, street.merged(), {}, silence());
  EXPECT_EQ(report.maps_taken_over, 1U);
  EXPECT_LT(report.tiles_decided, 10U);
  EXPECT_TRUE(canonicalText(street.merged()) == canonicalText(whole));
  EXPECT_TRUE(blocksOf(street.merged()) == blocksOf(whole));
}

}  // namespace
}  // namespace cluxel::mapping
