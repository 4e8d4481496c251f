// SPDX-License-Identifier: Apache-2.0
// Which cells of the ground are even, as roads and paths are and grass is not.
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

inline constexpr double kKerbLow_m = 0.06;      ///< a difference in height that ends a way
inline constexpr double kLeastEven_m2 = 10;     ///< smaller patches are dropped
inline constexpr double kLargestGap_m2 = 12;    ///< smaller holes, which things and shadows leave, are closed
inline constexpr double kLargestCut_m2 = 0.25;  ///< the same for holes that steps leave: no kerb is so short

/// Gives a tile's output of the stage "even".
using EvenTileSource = std::function<perception::EvenTile(const perception::TileKey&)>;

/// `keys`: of all tiles, ascending. Cost: about 1 ms a tile.
GroundCells groundCellsOf(std::vector<perception::TileKey> keys, const EvenTileSource& tileAt);

/// Connected cells where `inside` is 1, over the four neighbours or all eight. Cells of a part are in the order in
/// which they are found; parts are in the order of their first cells.
std::vector<std::vector<std::uint32_t>> connectedCells(const TileCells& cells, const std::vector<std::uint8_t>& inside,
                                                       bool over_corners);

}  // namespace cluxel::mapping
