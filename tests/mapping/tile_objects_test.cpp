// SPDX-License-Identifier: Apache-2.0
// What single tiles say of objects is what the scene of the whole map says.
#include "mapping/regions/tile_objects.hpp"

#include <gtest/gtest.h>

#include "mapping/build/tile_stages.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/regions/object_extents.hpp"
#include "mapping/street_map.hpp"

namespace cluxel::mapping {
namespace {

class TileObjectsTest : public StreetMap {};

TEST_F(TileObjectsTest, ClassesAreThoseOfTheObjects) {
  std::vector<std::string> classes;
  for (const rules::SemanticObject& object : map->objects()) classes.push_back(object.class_iri);
  EXPECT_GT(classes.size(), 5U);
  EXPECT_EQ(map->objectClasses(), classes);
}

TEST_F(TileObjectsTest, TopsAreThoseOfTheScene) {
  const std::vector<double> tops = topsOfObjects(*map);
  ASSERT_EQ(tops.size(), map->objects().size());
  for (std::size_t i = 0; i < tops.size(); ++i)
    EXPECT_EQ(tops[i], geometryOf(map->scene().cluxels, cluxelsOf(map->objects()[i])).top_m) << i;
}

void expectSame(const ObjectGeometry& found, const ObjectGeometry& expected) {
  EXPECT_EQ(found.box.center, expected.box.center);
  EXPECT_EQ(found.box.size, expected.box.size);
  EXPECT_EQ(found.box.yaw_rad, expected.box.yaw_rad);
  EXPECT_EQ(found.bottom_m, expected.bottom_m);
  EXPECT_EQ(found.top_m, expected.top_m);
  EXPECT_EQ(found.point_count, expected.point_count);
}

TEST_F(TileObjectsTest, ExtentsOfObjectsAndPartsHaveTheBitsOfTheScene) {
  const perception::SceneCluxels& cluxels = map->scene().cluxels;
  const auto extents = extentsOfObjects(*map);
  ASSERT_EQ(extents.size(), map->objects().size());
  std::size_t parts = 0;
  for (std::size_t i = 0; i < extents.size(); ++i) {
    const rules::SemanticObject& object = map->objects()[i];
    ASSERT_EQ(extents[i].size(), object.parts.size()) << i;
    ExtentSums whole;
    for (std::size_t part = 0; part < extents[i].size(); ++part, ++parts) {
      EXPECT_EQ(extents[i][part].part_class, object.parts[part].part_class);
      expectSame(geometryOf(extents[i][part].sums), geometryOf(cluxels, object.parts[part].cluxels));
      whole.add(extents[i][part].sums);
    }
    expectSame(geometryOf(std::move(whole)), geometryOf(cluxels, cluxelsOf(object)));
  }
  EXPECT_GT(parts, extents.size()) << "no object has parts";
}

TEST_F(TileObjectsTest, HeightsAreThoseOfTheScene) {
  const perception::SceneCluxels& cluxels = map->scene().cluxels;
  const std::vector<CluxelHeight> heights = heightsOfCluxels(*map);
  ASSERT_EQ(heights.size(), cluxels.size());
  for (std::size_t c = 0; c < heights.size(); ++c) {
    EXPECT_EQ(static_cast<double>(heights[c].z_map_m), cluxels.center[c].z());
    EXPECT_EQ(heights[c].above_ground_m, cluxels.height_above_ground[c]);
  }
}

TEST_F(TileObjectsTest, GroundIsThatOfTheStages) {
  const auto ground = groundOfTiles(*map);
  const auto& expected = map->stages().ground();
  ASSERT_EQ(ground.size(), expected.size());
  for (const auto& [tile, here] : ground) EXPECT_EQ(here.height, expected.at(tile).height);
}

TEST_F(TileObjectsTest, EveryTileIsVisitedOnceWithItsPointsWhateverTheRegions) {
  const TileStages& stages = map->stagesWithPoints();
  const auto object_of = objectOfCluxel({map->objects(), {}}, map->scene().cluxels.size());
  std::map<perception::TileKey, std::vector<std::uint32_t>> expected;
  std::uint32_t first = 0;
  for (const auto& [tile, cluxels] : stages.cluxels()) {
    std::vector<std::uint32_t>& objects = expected[tile];
    for (const std::uint32_t cluxel : cluxels.point_cluxel) objects.push_back(object_of[first + cluxel]);
    first += static_cast<std::uint32_t>(cluxels.size());
  }
  const perception::TileSet tiles = storedTiles(map->transaction());
  for (const std::size_t max_cluxels : {std::size_t{1}, std::size_t{1500}, std::size_t{first}}) {
    std::map<perception::TileKey, std::vector<std::uint32_t>> found;
    forEachTileOfPoints(
        *map, tiles,
        [&](const TileOfPoints& tile) {
          EXPECT_TRUE(found.emplace(tile.key, tile.object).second);
          EXPECT_EQ(tile.points.z, stages.points().at(tile.key).z);
        },
        max_cluxels);
    EXPECT_EQ(found, expected) << max_cluxels;
  }
}

TEST_F(TileObjectsTest, OnlyTheTilesThatAreAskedForAreVisited) {
  const perception::TileKey wanted = *storedTiles(map->transaction()).begin();
  std::vector<perception::TileKey> visited;
  forEachTileOfPoints(
      *map, {wanted}, [&](const TileOfPoints& tile) { visited.push_back(tile.key); }, 1000);
  EXPECT_EQ(visited, std::vector{wanted});
}

}  // namespace
}  // namespace cluxel::mapping
