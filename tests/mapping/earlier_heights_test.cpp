// SPDX-License-Identifier: Apache-2.0
// Maps of stages 20 and earlier, whose tiles hold heights as measured: they are read as they are, and not mixed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/rdf_loading.hpp"
#include "mapping/map_state.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/regions/answered_clouds.hpp"
#include "mapping/regions/map_regions.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/stored_grid.hpp"
#include "mapping/window/semantic_update.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Computes all tiles, and what is decided about them, from heights as measured.
void computeAsMeasured(const fs::path& map) {
  WriteTransaction transaction = Environment::open(map, OpenMode::ReadWrite)->write();
  storeGrid(transaction, storedGrid(transaction).withHeightsAsMeasured());
  const ParsedInputs parsed = parseInputs(storedInputs(transaction));
  TileStages stages(parsed.model, parsed.inputs.params);
  stages.computeAnew(transaction, storedTiles(transaction), 2, silence());
  updateSemanticLayer(transaction, parsed, stages, ChangedInputs::Any, {}, silence());
  transaction.commit();
}

class EarlierHeights : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 3, .stops = 3, .size_m = 45, .points_per_stop = 8'000});
    folder = new ScratchFolder();
    buildMap(scansOf({campus->files()[0], campus->files()[1]}), shippedInputs(), file(), {}, silence());
    computeAsMeasured(file());
    map = new MapReader(file());
  }
  static void TearDownTestSuite() {
    delete map;
    delete folder;
    delete campus;
  }
  static fs::path file() { return folder->path() / "earlier.clx"; }

  /// A copy that a change may try to write.
  fs::path copied() const {
    writeFile(own.path() / "copy.clx", readFile(file()));
    return own.path() / "copy.clx";
  }
  static std::string anObject() { return "<" + rdf::iriOfObject(map->objectIds().at(0)) + ">"; }

  ScratchFolder own;
  static inline SmallCampus* campus = nullptr;
  static inline ScratchFolder* folder = nullptr;
  static inline MapReader* map = nullptr;
};

TEST_F(EarlierHeights, AreThoseOfTheKeptPointsAndTheirCluxels) {
  std::map<ScanId, PointAnswers> answers;
  std::map<ScanId, std::vector<float>> heights;
  for (const Cloud& cloud : map->clouds()) {
    answers.emplace(cloud.id, map->answersFor(cloud));
    const ScanPoints points = map->pointsOf(cloud.id);
    for (std::size_t i = 0; i < points.size(); ++i)
      heights[cloud.id].push_back(
          static_cast<float>(toMap(cloud.T_map_sensor, {points.x[i], points.y[i], points.z[i]}).z()));
  }
  std::size_t between_steps = 0;
  std::uint32_t first = 0;
  for (const auto& [key, tile] : map->stagesWithPoints().points()) {
    const CluxelTile& cluxels = map->stagesWithPoints().cluxels().at(key);
    for (std::size_t i = 0; i < tile.size(); ++i) {
      const ScanId scan = tile.scans[tile.scan[i]];
      EXPECT_EQ(answers.at(scan).cluxel[tile.point[i]], first + cluxels.point_cluxel[i]);
      EXPECT_EQ(tile.z[i], heights.at(scan)[tile.point[i]]);
      if (tile.z[i] * 4096 != std::round(tile.z[i] * 4096)) ++between_steps;
    }
    first += static_cast<std::uint32_t>(cluxels.size());
  }
  EXPECT_GT(between_steps, 100U);
}

TEST_F(EarlierHeights, GiveTheSameAnswersRegionByRegion) {
  std::size_t clouds = 0;
  for (const std::size_t max_cluxels : {std::size_t{500}, kAnsweredCluxels})
    forEachAnsweredCloud(
        *map,
        [&](const Cloud& cloud, const ScanPoints&, const PointAnswers& answers) {
          ++clouds;
          const PointAnswers expected = map->answersFor(cloud);
          EXPECT_EQ(answers.cluxel, expected.cluxel);
          EXPECT_EQ(answers.object, expected.object);
        },
        max_cluxels);
  EXPECT_EQ(clouds, 2 * map->clouds().size());
  std::map<ScanId, PointAnswers> answers;
  std::size_t visited = 0, all = 0;
  for (const Cloud& cloud : map->clouds()) {
    answers.emplace(cloud.id, map->answersFor(cloud));
    all += answers.at(cloud.id).cluxel.size();
  }
  MapRegions regions(*map, 500);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const MapRegion region = regions.read(r);
    for (const Cloud& cloud : map->clouds())
      regions.forEachPoint(region, cloud, [&](const Eigen::Vector3d&, std::uint32_t cluxel, std::size_t point) {
        ++visited;
        EXPECT_EQ(region.number.at(cluxel), answers.at(cloud.id).cluxel[point]);
      });
  }
  EXPECT_EQ(visited, all);
}

/// As if the map were of this version.
TEST_F(EarlierHeights, ReadAsIfTheyWereRoundedAreRefusedAsDamage) {
  const fs::path damaged = copied();
  {
    WriteTransaction transaction = Environment::open(damaged, OpenMode::ReadWrite)->write();
    storeGrid(transaction, {});
    transaction.commit();
  }
  const MapReader reader(damaged);
  const auto expectRefused = [](const std::function<void()>& act) {
    try {
      act();
      FAIL() << "points of another rounding have cluxels";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
      EXPECT_THAT(error.what(), HasSubstr("for which no point of the tile stands; the map is damaged"));
    }
  };
  expectRefused([&] {
    for (const Cloud& cloud : reader.clouds()) reader.answersFor(cloud);
  });
  expectRefused([&] { forEachAnsweredCloud(reader, [](const Cloud&, const ScanPoints&, const PointAnswers&) {}); });
  expectRefused([&] {
    MapRegions regions(reader, kAnsweredCluxels);
    const MapRegion region = regions.read(0);
    for (const Cloud& cloud : reader.clouds()) regions.forEachPoint(region, cloud, [](auto&&...) {});
  });
}

TEST_F(EarlierHeights, AreNotMixedWithRoundedOnes) {
  const fs::path changed = copied();
  const fs::path statements = own.path() / "statements.ttl";
  writeFile(statements, anObject() + " a <" + vocabulary::clx("UtilityPole") + "> .\n");
  const std::string stated = "INSERT DATA { " + anObject() + " a <" + vocabulary::clx("UtilityPole") + "> }";
  const std::string before = canonicalText(*map);
  for (const std::function<void()>& change : std::vector<std::function<void()>>{
           [&] { extendMap(changed, scansOf({campus->files()[2]}), {}, silence()); },
           [&] { retractScans(changed, {map->clouds().at(0).id}, {}, silence()); },
           [&] { updateMap(changed, stated, {}, silence()); },
           [&] { loadRdfFiles(changed, {statements}, {}, silence()); },
       })
    try {
      change();
      ADD_FAILURE() << "tiles of two roundings are in one map";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
      EXPECT_THAT(error.what(), HasSubstr(changed.string() + ": was made by another version"));
    }
  EXPECT_TRUE(canonicalText(MapReader(changed)) == before);
}

TEST_F(EarlierHeights, StayWhenFactsComeThatDecideNothing) {
  const fs::path changed = copied(), facts = own.path() / "facts.ttl";
  writeFile(facts, "<https://example.org/b> <https://example.org/p> 2 .\n");
  EXPECT_EQ(updateMap(changed, "INSERT DATA { <https://example.org/a> <https://example.org/p> 1 }", {}, silence())
                .change.tiles_decided,
            0U);
  EXPECT_EQ(loadRdfFiles(changed, {facts}, {}, silence()).added, 1U);
  EXPECT_EQ(MapReader(changed).objectIds(), map->objectIds());
}

TEST_F(EarlierHeights, AreToldByABlockThatMustBeWhole) {
  EXPECT_FALSE(storedGrid(map->transaction()).roundsHeights());
  const fs::path built = own.path() / "built.clx";
  buildMap(scansOf({campus->files()[0]}), shippedInputs(), built, {}, silence());
  EXPECT_EQ(storedGrid(MapReader(built).transaction()), TileGrid());
  WriteTransaction transaction = Environment::open(built, OpenMode::ReadWrite)->write();
  transaction.putBlock(tables::kMeta, tables::kHeightsKey, "some");
  EXPECT_THROW(storedGrid(transaction), Error);
}

}  // namespace
}  // namespace cluxel::mapping
