// SPDX-License-Identifier: Apache-2.0
// Square cells over the tiles of a map. Tiles that the map does not have take no memory.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "perception/features/even_tile.hpp"

namespace cluxel::mapping {

inline constexpr int kCellsPerTile = perception::kEvenCellsPerTile;
inline constexpr double kWayCell_m = perception::kEvenCell_m;
inline constexpr std::uint32_t kCellsOfTile = perception::kEvenCellsOfTile;
inline constexpr std::uint32_t kNoCell = 0xffffffffU;

/// Column and row of a cell of the map.
struct CellPlace {
  std::int64_t x = 0, y = 0;
};

/// `local`: the number of a cell in its tile, row by row.
inline CellPlace placeOf(const perception::TileKey& tile, std::uint32_t local) {
  return {std::int64_t{tile.x} * kCellsPerTile + local % kCellsPerTile,
          std::int64_t{tile.y} * kCellsPerTile + local / kCellsPerTile};
}

/// [m, map]
inline Eigen::Vector2d centreOf(const CellPlace& place) {
  return kWayCell_m * Eigen::Vector2d(static_cast<double>(place.x) + 0.5, static_cast<double>(place.y) + 0.5);
}

/// Numbers the cells tile by tile, and row by row in a tile. The order of two cells does not depend on other tiles.
class TileCells {
 public:
  /// `keys`: ascending.
  explicit TileCells(std::vector<perception::TileKey> keys);

  std::uint32_t size() const { return static_cast<std::uint32_t>(keys_.size()) * kCellsOfTile; }
  std::span<const perception::TileKey> keys() const { return keys_; }
  /// The number of a neighbour of a tile, in the order of ringOf(); kNoCell when there is none.
  std::uint32_t ringTile(std::uint32_t slot, std::size_t ring) const { return ring_[slot][ring]; }
  /// The cell that lies `dx` columns and `dy` rows farther, at most a tile each; kNoCell outside the tiles.
  std::uint32_t step(std::uint32_t cell, int dx, int dy) const {
    const int x = static_cast<int>(cell % kCellsPerTile) + dx;
    const int y = static_cast<int>(cell % kCellsOfTile / kCellsPerTile) + dy;
    if (x >= 0 && y >= 0 && x < kCellsPerTile && y < kCellsPerTile)
      return cell - cell % kCellsOfTile + static_cast<std::uint32_t>(y * kCellsPerTile + x);
    return stepOut(cell / kCellsOfTile, x, y);
  }
  /// Whole numbers over the whole map: those of neighbours differ by one.
  CellPlace placeOf(std::uint32_t cell) const {
    return cluxel::mapping::placeOf(keys_[cell / kCellsOfTile], cell % kCellsOfTile);
  }
  /// [m, map]
  Eigen::Vector2d centreOf(std::uint32_t cell) const { return cluxel::mapping::centreOf(placeOf(cell)); }

 private:
  std::uint32_t stepOut(std::uint32_t slot, int x, int y) const;

  std::vector<perception::TileKey> keys_;
  std::vector<std::array<std::uint32_t, 9>> ring_;  ///< numbers of tiles in keys_, as ringOf(); kNoCell: none
};

/// The eight steps to the neighbours of a cell, in a circle that begins with +x.
inline constexpr std::array<std::array<int, 2>, 8> kAroundCell{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

}  // namespace cluxel::mapping
