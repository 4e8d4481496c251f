// SPDX-License-Identifier: Apache-2.0
// Neighbouring tiles are computed together; what comes out of a tile does not depend on which.
#include "mapping/ways/way_stage.hpp"

#include <algorithm>

#include "mapping/ways/kerbs.hpp"
#include "mapping/ways/region_parts.hpp"
#include "mapping/ways/side_views.hpp"
#include "mapping/ways/skeleton.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

constexpr std::uint16_t kEndDistance2 = 6;  // 0.6 m from the edge
constexpr int kWayLevels = kFarthestEdge - 1;

// A tile's cells see the ring to its end, and what they depend on must not lie farther.
static_assert(2 * kWayLevels + kSeenAlong <= kCellsPerTile);
static_assert(2 * kLongestPart + 6 <= kCellsPerTile);

std::vector<TileKey> listOf(const TileSet& tiles) {
  return {tiles.begin(), tiles.end()};
}

/// Lines of cells in all tiles of some ground.
struct LinesOfGround {
  std::vector<std::uint16_t> edge_distance2;
  std::vector<std::uint8_t> skeleton;
};

LinesOfGround linesIn(const TileCells& cells, const std::vector<std::uint8_t>& inside, int levels,
                      std::uint16_t end_distance2) {
  LinesOfGround lines{squaredEdgeDistances(cells, inside), {}};
  lines.skeleton = skeletonOf(cells, lines.edge_distance2, levels, end_distance2);
  return lines;
}

/// The cells of a tile's lines; `visit` sees the number of each in the ground.
template <typename Visit>
LineCells lineCellsOf(const GroundCells& ground, const LinesOfGround& lines, std::uint32_t slot, const Visit& visit) {
  LineCells found;
  for (std::uint32_t local = 0; local < kCellsOfTile; ++local) {
    const std::uint32_t cell = slot * kCellsOfTile + local;
    if (lines.skeleton[cell] == 0) continue;
    found.cell.push_back(static_cast<std::uint16_t>(local));
    found.edge_distance2.push_back(lines.edge_distance2[cell]);
    found.height.push_back(ground.height[cell]);
    visit(cell);
  }
  return found;
}

}  // namespace

std::map<TileKey, SurfaceTile> surfaceTilesOf(const TileSet& wanted, const TileSet& context,
                                              const EvenTileSource& tileAt) {
  const GroundCells ground = surfaceOf(listOf(context), tileAt);
  std::map<TileKey, SurfaceTile> tiles;
  auto cell = ground.even.begin();
  for (const TileKey& key : context) {
    if (wanted.contains(key)) tiles.emplace(key, SurfaceTile(cell, cell + kCellsOfTile));
    cell += kCellsOfTile;
  }
  return tiles;
}

std::map<TileKey, WayTile> wayTilesOf(const TileSet& wanted, const TileSet& context, const EvenTileSource& tileAt,
                                      const SurfaceTileSource& surfaceAt) {
  const GroundCells ground = groundCellsOf(listOf(context), tileAt, surfaceAt);
  const LinesOfGround middle = linesIn(ground.cells, ground.even, kWayLevels, kEndDistance2);
  const std::vector<float> steps = kerbSteps(ground);
  std::vector<std::uint8_t> is_kerb(steps.size());
  std::transform(steps.begin(), steps.end(), is_kerb.begin(), [](float step) { return step > 0 ? 1 : 0; });
  const LinesOfGround kerbs = linesIn(ground.cells, is_kerb, kKerbLevels, 1);
  const RegionParts regions(ground);
  std::map<TileKey, WayTile> tiles;
  for (std::uint32_t slot = 0; slot < context.size(); ++slot) {
    const TileKey& key = ground.cells.keys()[slot];
    if (!wanted.contains(key)) continue;
    WayTile& tile = tiles[key];
    tile.key = key;
    tile.middle = lineCellsOf(ground, middle, slot, [&](std::uint32_t cell) {
      tile.across.push_back(acrossFrom(ground, middle.skeleton, cell));
      tile.region.push_back(regions.partAt(cell));
    });
    tile.kerbs = lineCellsOf(ground, kerbs, slot, [&](std::uint32_t cell) { tile.step_m.push_back(steps[cell]); });
    tile.parts = regions.partsOf(slot);
    tile.links = regions.linksOf(slot);
  }
  return tiles;
}

}  // namespace cluxel::mapping
