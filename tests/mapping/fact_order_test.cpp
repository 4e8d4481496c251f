// SPDX-License-Identifier: Apache-2.0
// Things that lie near each other get neighbouring ids, so that a change of one place touches few pages.
#include "mapping/facts/fact_order.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <set>
#include <vector>

#include "mapping/small_campus.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

TEST(MortonCode, KeepsTheTilesOfEachAlignedSquareTogether) {
  constexpr std::int32_t kEdge = 16;
  std::map<std::uint64_t, TileKey> along;
  for (std::int32_t x = -kEdge; x < kEdge; ++x)
    for (std::int32_t y = -kEdge; y < kEdge; ++y) along.emplace(mortonCode({x, y}), TileKey{x, y});
  ASSERT_EQ(along.size(), std::size_t{4 * kEdge * kEdge});
  for (const std::int32_t size : {2, 4, 8, 16}) {
    const auto square = [&](const TileKey& tile) { return TileKey{(tile.x + kEdge) / size, (tile.y + kEdge) / size}; };
    std::set<TileKey> left;
    const TileKey* last = nullptr;
    for (const auto& [code, tile] : along) {
      if (last != nullptr && square(*last) != square(tile)) left.insert(square(*last));
      EXPECT_FALSE(left.contains(square(tile))) << "squares of " << size << ": " << tile.x << ", " << tile.y;
      last = &tile;
    }
  }
  EXPECT_LT(mortonCode({-1, -1}), mortonCode({0, 0}));
  EXPECT_NE(mortonCode({std::numeric_limits<std::int32_t>::min(), 0}),
            mortonCode({std::numeric_limits<std::int32_t>::max(), 0}));
}

/// In how many steps from one thing to the next, by ascending ids, the tile changes.
std::size_t changesOfTile(const std::map<TermId, TileKey>& tile_of) {
  std::size_t changes = 0;
  for (auto next = tile_of.begin(), before = next++; next != tile_of.end(); before = next++)
    changes += next->second != before->second ? 1 : 0;
  return changes;
}

TEST(FactOrder, GivesNeighbouringThingsNeighbouringIds) {
  const SmallCampus campus({.seed = 12, .stops = 3, .size_m = 90, .points_per_stop = 12000, .max_range_m = 45});
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "map.clx";
  buildMap(scansOf(campus.files()), shippedInputs(), file, {}, silence());
  const MapReader map(file);
  std::map<TermId, TileKey> primitives, objects;
  std::set<TileKey> tiles;
  for (const Primitive& primitive : map.scene().primitives) {
    const auto id = map.quads().idOf(Term::iri(iriOfPrimitive(primitive.id)));
    ASSERT_TRUE(id);
    primitives.emplace(*id, TileGrid().tileOf(primitive.centroid));
    tiles.insert(TileGrid().tileOf(primitive.centroid));
  }
  for (const std::size_t number : objectsByPlace(map.scene(), map.objects())) {
    const SemanticObject& object = map.objects()[number];
    const auto id = map.quads().idOf(Term::iri(iriOfObject(object.id)));
    ASSERT_TRUE(id);
    if (!object.is_class_wide)
      objects.emplace(*id, TileGrid().tileOf(map.scene().primitives[object.parts.at(0).primitives.at(0)].centroid));
  }
  ASSERT_GT(tiles.size(), 20U);
  ASSERT_GT(primitives.size(), 10 * tiles.size());
  // With ids in the order of content hashes nearly each step changes the tile.
  EXPECT_LT(changesOfTile(primitives), primitives.size() / 3);
  EXPECT_LT(changesOfTile(objects), objects.size() / 2);
}

TEST(FactOrder, ListsEveryObjectAndPrimitiveOnce) {
  Scene scene;
  for (const double x : {40.0, -40.0, 3.0, 5.0}) scene.primitives.emplace_back().centroid = {x, 1, 0};
  EXPECT_EQ(primitivesByPlace(scene), (std::vector<PrimitiveIndex>{1, 2, 3, 0}));
  std::vector<SemanticObject> objects(3);
  objects[0].parts.push_back({"", {0, 2}, {}});
  objects[2].parts.push_back({"", {1}, {}});
  EXPECT_EQ(objectsByPlace(scene, objects), (std::vector<std::size_t>{2, 0, 1}));
}

}  // namespace
}  // namespace cluxel::mapping
