// SPDX-License-Identifier: Apache-2.0
// A window asks for the tiles near things at its edge, and not for those near the ground alone.
#include "mapping/window/likely_tiles.hpp"

#include <gtest/gtest.h>

#include "mapping/clouds/scan_store.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {
namespace {

using perception::TileKey;
using perception::TileSet;

const ContentHash kGround = ContentHasher().addText("ground").finish();

/// A tile with its ground and one thing 2 m wide, from a place in the tile.
void storeTile(rdf::WriteTransaction& transaction, const TileKey& tile, const Eigen::Vector3f& thing) {
  TileLayer layer;
  layer.key = tile;
  const Eigen::AlignedBox3f whole(Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(16, 16, 0));
  layer.primitives.push_back({ContentHasher().addText("floor").add(tile.x).finish(), 0, 0, whole});
  layer.primitives.push_back({ContentHasher().addText("thing").add(tile.x).finish(),
                              0,
                              0,
                              {thing, Eigen::Vector3f(thing + Eigen::Vector3f(2, 2, 2))}});
  layer.shares.push_back({kGround, "part", {0}});
  layer.share_of_cluxel = {0, kNoShare};
  transaction.putBlock(tables::kTileLayers, tables::keyOf(tile), toBytes(layer));
}

TEST(LikelyTiles, LieWithinReachOfThingsInChangedTiles) {
  const auto environment = rdf::Environment::temporary();
  rdf::WriteTransaction transaction = environment->write();
  storeTiles(transaction, {{0, 0}, {1, 0}, {2, 0}, {-1, 0}, {0, 1}, {1, 1}, {5, 5}});
  storeTile(transaction, {0, 0}, {1.5F, 7, 0});
  storeTile(transaction, {1, 0}, {10.5F, 7, 0});
  const TileSet changed{{0, 0}, {1, 0}};
  EXPECT_EQ(likelyTiles(transaction, storedTiles(transaction), changed, {kGround}, 1, 1),
            (TileSet{{0, 0}, {1, 0}, {-1, 0}}))
      << "1.5 m away, and layers reach 1 m farther; the next is 3.5 m away";
  EXPECT_EQ(likelyTiles(transaction, storedTiles(transaction), changed, {kGround}, 3, 1),
            (TileSet{{0, 0}, {1, 0}, {-1, 0}, {2, 0}}));
  const TileSet all{{0, 0}, {1, 0}, {2, 0}, {-1, 0}, {0, 1}, {1, 1}};
  EXPECT_EQ(likelyTiles(transaction, storedTiles(transaction), changed, {kGround}, 7, 1), all);
  EXPECT_EQ(likelyTiles(transaction, storedTiles(transaction), changed, {}, 2, 1), all) << "the floor counts";
  EXPECT_EQ(likelyTiles(transaction, storedTiles(transaction), {{5, 5}}, {kGround}, 8, 9), TileSet{})
      << "a tile without a layer";
}

TEST(LikelyTiles, FollowThingsFromLayerToLayer) {
  const auto environment = rdf::Environment::temporary();
  rdf::WriteTransaction transaction = environment->write();
  TileSet row;
  for (int x = 0; x < 6; ++x) {
    row.insert({x, 0});
    storeTile(transaction, {x, 0}, {7, 7, 0});  // 14 m from one thing to the next
  }
  storeTiles(transaction, row);
  for (std::uint32_t layers = 1; layers < 5; ++layers)
    EXPECT_EQ(likelyTiles(transaction, storedTiles(transaction), {{0, 0}}, {kGround}, 14, layers).size(), layers + 1)
        << layers;
}

/// What is one primitive is reached as a whole, in one layer.
TEST(LikelyTiles, FollowPrimitivesThroughTiles) {
  const auto environment = rdf::Environment::temporary();
  rdf::WriteTransaction transaction = environment->write();
  TileSet row;
  for (int x = 0; x < 4; ++x) {
    row.insert({x, 0});
    TileLayer layer;
    layer.key = {x, 0};
    layer.primitives.push_back(
        {ContentHasher().addText("fence").finish(), 0, 0, {Eigen::Vector3f(0, 7, 0), Eigen::Vector3f(16, 8, 2)}});
    layer.share_of_cluxel = {kNoShare};
    transaction.putBlock(tables::kTileLayers, tables::keyOf(layer.key), toBytes(layer));
  }
  storeTiles(transaction, row);
  EXPECT_EQ(likelyTiles(transaction, storedTiles(transaction), {{0, 0}}, {kGround}, 2, 1), row);
}

TEST(LikelyTiles, LeaveOutTheGroundByTheShippedRules) {
  const ScratchFolder folder;
  const SmallCampus campus({.seed = 4, .stops = 1, .size_m = 45, .points_per_stop = 1500});
  const std::filesystem::path file = folder.path() / "map.clx";
  buildMap(scansOf(campus.files()), shippedInputs(), file, {}, silence());
  const std::set<ContentHash> lone = objectsOfLoneSeeds(parseInputs(shippedInputs()).rules);
  ASSERT_EQ(lone.size(), 1U);
  const auto ground = storedRecord(rdf::Environment::open(file, rdf::OpenMode::ReadOnly)->read(), *lone.begin());
  ASSERT_TRUE(ground.has_value());
  EXPECT_EQ(ground->class_iri, rdf::vocabulary::clx("Ground"));
}

}  // namespace
}  // namespace cluxel::mapping
