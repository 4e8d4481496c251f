// SPDX-License-Identifier: Apache-2.0
// A cell's number is that of the first cell in its row plus the cells before it there: a row of a tile is one word.
#include "mapping/ways/line_graph.hpp"

#include <array>
#include <bit>

namespace cluxel::mapping {

namespace {

static_assert(kCellsPerTile == 64, "a row of cells is one word");

/// The numbers of the cells of one tile.
class CellNumbers {
 public:
  /// `first`: the number of the tile's first cell.
  CellNumbers(const std::vector<std::uint16_t>& cells, std::uint32_t first) {
    for (const std::uint16_t cell : cells) row_[cell / kCellsPerTile] |= std::uint64_t{1} << cell % kCellsPerTile;
    for (std::size_t y = 0; y < row_.size(); ++y) {
      first_[y] = first;
      first += static_cast<std::uint32_t>(std::popcount(row_[y]));
    }
  }
  /// kNoCell where there is none.
  std::uint32_t at(std::uint32_t cell) const {
    const std::uint64_t row = row_[cell / kCellsPerTile], bit = std::uint64_t{1} << cell % kCellsPerTile;
    if ((row & bit) == 0) return kNoCell;
    return first_[cell / kCellsPerTile] + static_cast<std::uint32_t>(std::popcount(row & (bit - 1)));
  }

 private:
  std::array<std::uint64_t, kCellsPerTile> row_{};
  std::array<std::uint32_t, kCellsPerTile> first_{};
};

}  // namespace

LineGraph lineGraphOf(const TileCells& cells, std::span<const WayTile> tiles, LineCells WayTile::*lines) {
  LineGraph graph;
  std::vector<CellNumbers> numbers;
  std::vector<std::uint32_t> numbers_of(tiles.size(), kNoCell);  // of each tile with cells
  for (std::size_t slot = 0; slot < tiles.size(); ++slot) {
    const LineCells& own = tiles[slot].*lines;
    if (own.cell.empty()) continue;
    numbers_of[slot] = static_cast<std::uint32_t>(numbers.size());
    numbers.emplace_back(own.cell, graph.size());
    for (const std::uint16_t cell : own.cell) graph.place.push_back(placeOf(tiles[slot].key, cell));
    graph.edge_distance2.insert(graph.edge_distance2.end(), own.edge_distance2.begin(), own.edge_distance2.end());
    graph.height.insert(graph.height.end(), own.height.begin(), own.height.end());
  }
  graph.first_neighbour.reserve(graph.place.size() + 1);
  for (std::uint32_t slot = 0; slot < tiles.size(); ++slot)
    for (const std::uint16_t cell : (tiles[slot].*lines).cell) {
      for (const auto& [dx, dy] : kAroundCell) {
        const std::uint32_t near = cells.step(slot * kCellsOfTile + cell, dx, dy);
        if (near == kNoCell || numbers_of[near / kCellsOfTile] == kNoCell) continue;
        const std::uint32_t number = numbers[numbers_of[near / kCellsOfTile]].at(near % kCellsOfTile);
        if (number != kNoCell) graph.neighbour.push_back(number);
      }
      graph.first_neighbour.push_back(static_cast<std::uint32_t>(graph.neighbour.size()));
    }
  return graph;
}

}  // namespace cluxel::mapping
