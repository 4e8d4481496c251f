// SPDX-License-Identifier: Apache-2.0
// Which cells are kept of regions, until all is known that is near them.
#include "tasks/changes/kept_changes.hpp"

#include <gtest/gtest.h>

#include "tasks/changes/changed_parts.hpp"

namespace cluxel::tasks {
namespace {

constexpr perception::TileKey kWest{0, 0}, kEast{1, 0};

mapping::MapRegion regionOf(const perception::TileKey& tile) {
  mapping::MapRegion region;
  region.tiles.insert(tile);
  return region;
}

/// A board of changed cells, 0.1 m apart, that stands from one column to another along x: the part of it in a tile.
std::vector<PointCell> boardIn(const perception::TileKey& tile, int from, int to) {
  std::vector<PointCell> cells;
  for (int x = from; x < to; ++x)
    for (int z = 0; z < 4; ++z) {
      const Eigen::Vector3d place(0.1 * x + 0.05, 5, 0.1 * z + 1);
      if (perception::tileOf(place) != tile) continue;
      PointCell cell{.key = {tile, static_cast<std::uint64_t>(4 * x + z)}, .place = place, .scans = 31};
      cell.other.through_scans = 31;
      cells.push_back(cell);
    }
  return cells;
}

std::vector<PointCell> keptOf(const std::vector<PointCell>& west, const std::vector<PointCell>& east) {
  KeptCells kept;
  kept.add(regionOf(kWest), west, {kEast});
  kept.add(regionOf(kEast), east, {});
  return kept.take();
}

const int kBorder = static_cast<int>(perception::kTileSize_m * 10);  ///< between the tiles, in cells

TEST(KeptCells, FewCellsThatChangedAreDropped) {
  EXPECT_TRUE(keptOf(boardIn(kWest, 20, 22), {}).empty());
  EXPECT_TRUE(keptOf({}, boardIn(kEast, kBorder + 20, kBorder + 22)).empty());
}

TEST(KeptCells, FewCellsOfACluxelThatChangedAreKept) {
  std::vector<PointCell> cells = boardIn(kWest, 20, 22);
  cells.front().is_of_changed_cluxel = true;
  EXPECT_EQ(keptOf(cells, {}).size(), cells.size());
}

TEST(KeptCells, CellsOfAPossiblePartAreKeptWithWhatIsNear) {
  std::vector<PointCell> cells = boardIn(kWest, 20, 26);
  PointCell stable = cells.back();
  stable.key.cell = 9999, stable.place.x() += 0.2, stable.is_shared = true;
  cells.push_back(stable);
  PointCell far = stable;
  far.key.cell = 10000, far.place.x() += 2;
  cells.push_back(far);
  EXPECT_EQ(keptOf(cells, {}).size(), cells.size() - 1);
}

TEST(KeptCells, APartAcrossABorderStaysWhole) {
  const auto west = boardIn(kWest, kBorder - 2, kBorder + 2), east = boardIn(kEast, kBorder - 2, kBorder + 2);
  ASSERT_EQ(west.size(), 8U);
  ASSERT_EQ(east.size(), 8U);
  const std::vector<PointCell> kept = keptOf(west, east);
  EXPECT_EQ(kept.size(), 16U);
  EXPECT_EQ(possibleParts(kept).size(), 1U);
}

}  // namespace
}  // namespace cluxel::tasks
