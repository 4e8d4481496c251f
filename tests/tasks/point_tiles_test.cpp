// SPDX-License-Identifier: Apache-2.0
// Tiles that are asked for one by one are those of the whole page.
#include "tasks/view/point_tiles.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tasks/campus_map_fixture.hpp"

namespace cluxel::tasks {
namespace {

TEST(CampusMapPage, HasTheTilesThatAreServedOneByOne) {
  const mapping::MapReader& map = CampusMap::shared().map();
  const PointTiles all = pointTilesOf(map, 1'000'000'000);
  ASSERT_GT(all.tiles.size(), 1U);
  const PointTileSource source(map);
  for (int round = 0; round < 2; ++round)
    for (const PointTile& tile : all.tiles) {
      const ViewTileKey key{std::llround(tile.origin.x() / kViewTile_m), std::llround(tile.origin.y() / kViewTile_m)};
      const auto served = source.tile(map, key, all.intensity);
      ASSERT_TRUE(served);
      EXPECT_EQ(tileBytes(*served), tileBytes(tile));
    }
  EXPECT_FALSE(source.tile(map, {10'000, 10'000}, all.intensity));
}

}  // namespace
}  // namespace cluxel::tasks
