// SPDX-License-Identifier: Apache-2.0
// Which cells of the ground are part of a way's surface, as roads and paths are and grass is not.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "mapping/ways/tile_cells.hpp"
#include "perception/features/even_tile.hpp"

namespace cluxel::mapping {

struct GroundCells {
  TileCells cells;
  std::vector<float> height;           ///< of the ground [m, map]
  std::vector<std::uint8_t> measured;  ///< 1: a point of the ground lies in the cell
  std::vector<std::uint8_t> thing;     ///< 1: something stands or hangs there, up to perception::kThingTop_m
  std::vector<std::uint8_t> even;      ///< 1: part of a way's surface
};

inline constexpr double kKerbLow_m = 0.06;    ///< a difference in height that ends a way
inline constexpr double kLeastEven_m2 = 10;   ///< smaller patches are dropped unless they are longer than kLongestPart
inline constexpr double kLargestGap_m2 = 12;  ///< smaller holes, which things and shadows leave, are closed
/// Holes that are closed and patches that are dropped span at most so many columns and rows [cells].
inline constexpr int kLongestPart = 28;
inline constexpr double kLargestCut_m2 = 0.25;  ///< the same for holes that steps leave: no kerb is so short

/// Gives a tile's output of the stage "even".
using EvenTileSource = std::function<perception::EvenTile(const perception::TileKey&)>;

/// 1 for each cell of a tile that is part of a way's surface.
using SurfaceTile = std::vector<std::uint8_t>;
using SurfaceTileSource = std::function<SurfaceTile(const perception::TileKey&)>;

/// `even` of the result follows from the cells within 62: in tiles of which the whole ring is in `keys`, or in no map,
/// it is that of the whole map. `keys` ascend. Cost: about 0.5 ms a tile.
GroundCells surfaceOf(std::vector<perception::TileKey> keys, const EvenTileSource& tileAt);

/// The same with known surfaces.
GroundCells groundCellsOf(std::vector<perception::TileKey> keys, const EvenTileSource& tileAt,
                          const SurfaceTileSource& surfaceAt);

}  // namespace cluxel::mapping
