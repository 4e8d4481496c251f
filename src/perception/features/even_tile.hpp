// SPDX-License-Identifier: Apache-2.0
// The cells of a tile's ground that are even, as roads and paths are and grass is not.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "perception/clustering/tile_points.hpp"
#include "perception/features/ground_tile.hpp"

namespace cluxel::perception {

inline constexpr int kEvenCellsPerTile = 64;
inline constexpr std::uint32_t kEvenCellsOfTile = kEvenCellsPerTile * kEvenCellsPerTile;
inline constexpr double kEvenCell_m = kTileSize_m / kEvenCellsPerTile;

/// Points and ground of the tiles around are read this far [m].
inline constexpr double kEvenMargin_m = 1.0;

inline constexpr double kThingBottom_m = 0.2;  ///< above the ground: lower points are of the ground
inline constexpr double kThingTop_m = 2.0;
inline constexpr double kEvenSpread_m = 0.0025;  ///< of the ground about the plane of a window of 1.25 m
inline constexpr double kLargestNoise_m = 0.03;  ///< of points about the means of cells
inline constexpr double kEvenSlope = 0.2;        ///< rise over run of that plane
/// Heights are rounded to this step [m].
inline constexpr double kEvenStep_m = 1.0 / 2048;

/// Arrays have one number for each cell, row by row in y.
struct EvenTile {
  TileKey key;
  std::vector<float> height;            ///< of the ground, by points where there are some [m, map]
  std::vector<std::uint8_t> measured;   ///< 1: a point of the ground lies in the cell
  std::vector<std::uint8_t> thing;      ///< 1: something stands or hangs there, up to kThingTop_m
  std::vector<std::uint8_t> distance2;  ///< [cells], to the centre of the nearest even window over it, or kNotEven
  std::vector<float> even_height;       ///< of the plane of that window [m, map]; 0 where there is none
  static constexpr std::uint8_t kNotEven = 255;

  std::size_t size() const { return height.size(); }
};

/// The cells of the centre tile. A window of five by five cells is even when its points lie near a plane that is not
/// steep. Cost: about 40 ns a point, and 2 ms a tile.
EvenTile evenGroundOf(const Ring<TilePoints>& points, const Ring<GroundTile>& ground);

std::string toBytes(const EvenTile& tile);
/// Throws Error (StoreUnavailable) when the bytes are damaged or of another kind.
EvenTile evenTileFromBytes(std::string_view bytes);

}  // namespace cluxel::perception
