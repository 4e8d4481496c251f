// SPDX-License-Identifier: Apache-2.0
// The cells of the lines of all tiles, and which of them are neighbours.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mapping/ways/tile_cells.hpp"
#include "mapping/ways/way_tile.hpp"

namespace cluxel::mapping {

/// Cells are numbered tile by tile: the order of two cells does not depend on other tiles.
struct LineGraph {
  std::vector<CellPlace> place;
  std::vector<std::uint16_t> edge_distance2;  ///< as of squaredEdgeDistances()
  std::vector<float> height;                  ///< of the ground [m, map]
  std::vector<std::uint32_t> first_neighbour{0};
  std::vector<std::uint32_t> neighbour;

  std::uint32_t size() const { return static_cast<std::uint32_t>(place.size()); }
  /// In the order of kAroundCell.
  std::span<const std::uint32_t> neighboursOf(std::uint32_t cell) const {
    return std::span(neighbour).subspan(first_neighbour[cell], first_neighbour[cell + 1] - first_neighbour[cell]);
  }
};

/// `cells`: of the tiles, in the same order. `lines` chooses the lines of a tile.
LineGraph lineGraphOf(const TileCells& cells, std::span<const WayTile> tiles, LineCells WayTile::*lines);

}  // namespace cluxel::mapping
