// SPDX-License-Identifier: Apache-2.0
// Which cells of the ground are even, as roads and paths are and grass is not.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "mapping/ways/tile_cells.hpp"
#include "perception/clustering/tile_points.hpp"
#include "perception/features/ground_tile.hpp"

namespace cluxel::mapping {

struct GroundCells {
  TileCells cells;
  std::vector<float> height;           ///< of the ground [m, map]
  std::vector<std::uint8_t> measured;  ///< 1: a point of the ground lies in the cell
  std::vector<std::uint8_t> thing;     ///< 1: something stands or hangs there, up to kThingTop_m
  std::vector<std::uint8_t> even;      ///< 1: part of a way's surface
};

inline constexpr double kThingBottom_m = 0.2;  ///< above the ground: lower points are of the ground
inline constexpr double kThingTop_m = 2.0;
inline constexpr double kEvenSpread_m = 0.0025;  ///< of the ground about the plane of a window of 1.25 m
inline constexpr double kLargestNoise_m = 0.03;  ///< of points about the means of cells
inline constexpr double kEvenSlope = 0.2;        ///< rise over run of that plane
inline constexpr double kKerbLow_m = 0.06;       ///< a difference in height that ends a way
inline constexpr double kLeastEven_m2 = 10;      ///< smaller patches are dropped
inline constexpr double kLargestGap_m2 = 12;     ///< smaller holes, which things and shadows leave, are closed
inline constexpr double kLargestCut_m2 = 0.25;   ///< the same for holes that steps leave: no kerb is so short

/// Cost: about 30 ns a point, and 2 ms a tile.
GroundCells groundCellsOf(const std::map<perception::TileKey, perception::TilePoints>& points,
                          const std::map<perception::TileKey, perception::GroundTile>& ground);

/// Connected cells where `inside` is 1, over the four neighbours or all eight. Cells of a part are in the order in
/// which they are found; parts are in the order of their first cells.
std::vector<std::vector<std::uint32_t>> connectedCells(const TileCells& cells, const std::vector<std::uint8_t>& inside,
                                                       bool over_corners);

}  // namespace cluxel::mapping
