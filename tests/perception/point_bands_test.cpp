// SPDX-License-Identifier: Apache-2.0
// How stages follow each other through bands of tiles.
#include "perception/point_bands.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace cluxel::perception {
namespace {

TileSet randomTiles(std::mt19937& random) {
  TileSet tiles;
  for (int i = 0; i < 60; ++i)
    tiles.insert({static_cast<std::int32_t>(random() % 20) - 10, static_cast<std::int32_t>(random() % 9) - 4});
  return tiles;
}

/// The last stage that a stage reads; of points the points.
Stage readBy(Stage stage) {
  switch (stage) {
    case Stage::Points:
    case Stage::Cluxels:
      return Stage::Points;
    case Stage::Ground:
    case Stage::Summaries:
      return Stage::Cluxels;
    case Stage::Features:
    case Stage::Even:
      return Stage::Ground;
    case Stage::Labels:
      return Stage::Features;
    case Stage::Components:
      return Stage::Labels;
    default:
      return Stage::Components;
  }
}
/// Whether it reads it of the tiles around its own, too.
bool readsRing(Stage stage) {
  return stage != Stage::Points && stage != Stage::Summaries && stage != Stage::Components;
}

TEST(PointBands, LieAcrossTheLongerSide) {
  EXPECT_EQ(longerAxis({}), Axis::X);
  EXPECT_EQ(longerAxis({{0, 0}, {3, 2}}), Axis::X);
  EXPECT_EQ(longerAxis({{0, 0}, {2, 3}}), Axis::Y);
}

TEST(PointBands, EachStageComputesEachTileOnceAfterAllThatItReads) {
  std::mt19937 random(5);
  for (int round = 0; round < 40; ++round) {
    const TileSet tiles = randomTiles(random);
    const Axis axis = round % 2 == 0 ? Axis::X : Axis::Y;
    StageFront front(axis);
    std::array<TileSet, kStageCount> done;
    for (std::int64_t end = -12; !front.isAtEnd();) {
      end += 1 + static_cast<std::int64_t>(random() % 6);
      front.moveTo(end > 12 ? kEndOfRows : end);
      for (std::size_t stage = 0; stage < kStageCount; ++stage)
        for (const TileKey& tile : front.due(static_cast<Stage>(stage), tiles)) {
          EXPECT_TRUE(done[stage].insert(tile).second) << "computed twice";
          for (const TileKey& near : ringOf(tile))
            if (tiles.contains(near) && (near == tile || readsRing(static_cast<Stage>(stage)))) {
              EXPECT_TRUE(done[static_cast<std::size_t>(readBy(static_cast<Stage>(stage)))].contains(near))
                  << nameOf(static_cast<Stage>(stage));
            }
        }
    }
    for (const TileSet& of_stage : done) EXPECT_EQ(of_stage, tiles);
  }
}

TEST(PointBands, RowsFollowTheAxis) {
  const TileSet tiles{{0, 5}, {1, -1}, {2, 5}};
  EXPECT_EQ(StageFront(Axis::X).inRows(tiles), (std::vector<TileKey>{{0, 5}, {1, -1}, {2, 5}}));
  EXPECT_EQ(StageFront(Axis::Y).inRows(tiles), (std::vector<TileKey>{{1, -1}, {0, 5}, {2, 5}}));
}

}  // namespace
}  // namespace cluxel::perception
