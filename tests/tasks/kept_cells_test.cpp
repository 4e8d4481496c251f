// SPDX-License-Identifier: Apache-2.0
// Which cells are kept of regions, until all is known that is near them.
#include "tasks/changes/kept_cells.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

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
      if (perception::TileGrid().tileOf(place) != tile) continue;
      PointCell cell{.key = {tile, static_cast<std::uint64_t>(4 * x + z)}, .place = place, .scans = 31};
      cell.other.through_scans = 31;
      cells.push_back(cell);
    }
  return cells;
}

KeptCells::Parts keptOf(const std::vector<PointCell>& west, const std::vector<PointCell>& east) {
  const KeptCluxels no_clusters;
  KeptCells kept;
  kept.add(regionOf(kWest), west, {kEast}, no_clusters);
  kept.add(regionOf(kEast), east, {}, no_clusters);
  return kept.take();
}

const int kBorder = static_cast<int>(perception::kTileSize_m * 10);  ///< between the tiles, in cells

TEST(KeptCells, FewCellsThatChangedAreDropped) {
  EXPECT_TRUE(keptOf(boardIn(kWest, 20, 22), {}).cells.empty());
  EXPECT_TRUE(keptOf({}, boardIn(kEast, kBorder + 20, kBorder + 22)).cells.empty());
}

TEST(KeptCells, PossiblePartsAreKeptWithWhatIsNear) {
  std::vector<PointCell> cells = boardIn(kWest, 20, 26);
  PointCell stable = cells.back();
  stable.key.cell = 9999, stable.place.x() += 0.2, stable.is_shared = true;
  cells.push_back(stable);
  PointCell far = stable;
  far.key.cell = 10000, far.place.x() += 2;
  cells.push_back(far);
  EXPECT_EQ(keptOf(cells, {}).cells.size(), cells.size() - 1);
}

TEST(KeptCells, APartAcrossABorderStaysWhole) {
  const auto west = boardIn(kWest, kBorder - 2, kBorder + 2), east = boardIn(kEast, kBorder - 2, kBorder + 2);
  ASSERT_EQ(west.size(), 8U);
  ASSERT_EQ(east.size(), 8U);
  const KeptCells::Parts kept = keptOf(west, east);
  EXPECT_EQ(kept.cells.size(), 16U);
  ASSERT_EQ(kept.groups.size(), 1U);
  EXPECT_EQ(kept.groups.front().size(), 16U);
}

/// Cells of two tiles, some of which changed. What is evident hangs together over some decimetres.
std::vector<PointCell> randomCells(unsigned seed) {
  std::mt19937 random(seed);
  const auto chance = [&](double share) { return std::uniform_real_distribution<>(0, 1)(random) < share; };
  const double middle_m = perception::kTileSize_m;
  std::vector<PointCell> cells;
  for (int x = -20; x < 20; ++x)
    for (int y = 0; y < 20; ++y)
      for (int z = 0; z < 4; ++z) {
        if (chance(0.3)) continue;
        const Eigen::Vector3d place(middle_m + 0.1 * x + 0.05, 5 + 0.1 * y, 1 + 0.1 * z);
        PointCell cell{.key = {perception::TileGrid().tileOf(place), cells.size()}, .place = place, .scans = 31};
        cell.is_shared = (x / 7 + y / 6) % 2 == 0 ? chance(0.8) : chance(0.05);
        cell.own = {.hit_scans = 31, .rays = {.ended = 9, .passed = 1}};
        cell.other.through_scans = chance(0.5) ? 31 : 3;
        cells.push_back(cell);
      }
  return cells;
}

std::vector<std::vector<CellKey>> keysOf(const std::vector<ChangeGroup>& groups, const std::vector<PointCell>& cells) {
  std::vector<std::vector<CellKey>> keys;
  for (const ChangeGroup& group : groups) {
    auto& of_group = keys.emplace_back();
    for (const std::uint32_t cell : group) of_group.push_back(cells[cell].key);
  }
  return keys;
}

TEST(KeptCells, PartsAreThoseOfAllCellsTogether) {
  std::size_t parts = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<PointCell> cells = randomCells(seed);
    std::array<std::vector<PointCell>, 2> of_tile;
    for (const PointCell& cell : cells) of_tile[cell.key.tile == kWest ? 0 : 1].push_back(cell);
    const KeptCells::Parts kept = keptOf(of_tile[0], of_tile[1]);
    const auto expected = keysOf(changedParts(cells), cells);
    EXPECT_EQ(keysOf(partsAmong(kept.groups, kept.cells), kept.cells), expected) << "seed " << seed;
    parts += expected.size();
  }
  EXPECT_GE(parts, 20U);
}

}  // namespace
}  // namespace cluxel::tasks
