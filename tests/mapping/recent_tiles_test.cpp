// SPDX-License-Identifier: Apache-2.0
// Tiles are read once as long as they fit, and the tiles of the last calls stay.
#include "mapping/regions/recent_tiles.hpp"

#include <gtest/gtest.h>

#include <random>

namespace cluxel::mapping {
namespace {

using perception::TileKey;
using perception::TileSet;

/// A row of tiles of ten cluxels each.
CluxelRanges rowOf(int tiles) {
  CluxelRanges ranges;
  for (int x = 0; x < tiles; ++x) ranges[TileKey{x, 0}] = {static_cast<std::uint32_t>(10 * x), 10};
  return ranges;
}

TEST(RecentTiles, ReadsAllOfASmallMapAtTheSecondCallThatLacksOne) {
  RecentTiles recent(rowOf(5), 50);
  EXPECT_EQ(recent.use({{1, 0}, {2, 0}})->read, (TileSet{{1, 0}, {2, 0}}));
  EXPECT_TRUE(recent.use({{2, 0}})->read.empty());
  EXPECT_EQ(recent.use({{3, 0}})->read, (TileSet{{0, 0}, {3, 0}, {4, 0}}));
  for (int x = 0; x < 5; ++x) {
    const auto change = recent.use({{x, 0}});
    EXPECT_TRUE(change->read.empty() && change->dropped.empty());
  }
}

TEST(RecentTiles, DropsThoseOfTheOldestCalls) {
  RecentTiles recent(rowOf(5), 30);
  recent.use({{0, 0}, {1, 0}});
  recent.use({{2, 0}});
  recent.use({{0, 0}});
  const auto change = recent.use({{3, 0}});
  EXPECT_EQ(change->read, TileSet({{3, 0}}));
  EXPECT_EQ(change->dropped, TileSet({{1, 0}}));
  EXPECT_FALSE(recent.use({{0, 0}, {1, 0}, {2, 0}, {3, 0}})) << "they are too many";
}

TEST(RecentTiles, HoldsWhatEachCallNeedsAndNeverTooMuch) {
  std::mt19937 random(11);
  RecentTiles recent(rowOf(20), 70);
  TileSet held;
  for (int call = 0; call < 500; ++call) {
    TileSet tiles;
    for (unsigned count = random() % 7; count > 0; --count) tiles.insert(TileKey{static_cast<int>(random() % 20), 0});
    const auto change = recent.use(tiles);
    ASSERT_TRUE(change);
    for (const TileKey& tile : change->dropped) EXPECT_EQ(held.erase(tile), 1U);
    for (const TileKey& tile : change->read) EXPECT_TRUE(held.insert(tile).second);
    EXPECT_LE(held.size(), 7U);
    for (const TileKey& tile : tiles) EXPECT_TRUE(held.contains(tile));
  }
}

}  // namespace
}  // namespace cluxel::mapping
