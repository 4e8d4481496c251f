// SPDX-License-Identifier: Apache-2.0
// A window asks for the tiles near things at its edge, and not for those near the ground alone.
#include "mapping/window/likely_tiles.hpp"

#include <gtest/gtest.h>

#include "mapping/build/scan_store.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/layers/tile_layer.hpp"
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

TEST(LikelyTiles, LieWithinReachOfThingsInTheWindow) {
  const auto environment = rdf::Environment::temporary();
  rdf::WriteTransaction transaction = environment->write();
  storeTiles(transaction, {{0, 0}, {1, 0}, {2, 0}, {-1, 0}, {0, 1}, {1, 1}, {5, 5}});
  storeTile(transaction, {0, 0}, {1, 7, 0});
  storeTile(transaction, {1, 0}, {11, 7, 0});
  const TileSet window{{0, 0}, {1, 0}};
  EXPECT_EQ(likelyTiles(transaction, window, {kGround}, 2), (TileSet{{-1, 0}})) << "1 m away; the next is 3 m";
  EXPECT_EQ(likelyTiles(transaction, window, {kGround}, 4), (TileSet{{-1, 0}, {2, 0}}));
  EXPECT_EQ(likelyTiles(transaction, window, {kGround}, 8), (TileSet{{-1, 0}, {2, 0}, {0, 1}, {1, 1}}));
  EXPECT_EQ(likelyTiles(transaction, window, {}, 2), (TileSet{{-1, 0}, {2, 0}, {0, 1}, {1, 1}})) << "the floor counts";
  EXPECT_TRUE(likelyTiles(transaction, {{5, 5}}, {kGround}, 8).empty()) << "a tile without a layer";
}

TEST(LikelyTiles, LeaveOutTheGroundByTheShippedRules) {
  const std::set<ContentHash> lone = objectsOfLoneSeeds(parseInputs(shippedInputs()).rules);
  EXPECT_EQ(lone.size(), 1U);
}

}  // namespace
}  // namespace cluxel::mapping
