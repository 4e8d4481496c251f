// SPDX-License-Identifier: Apache-2.0
// Neighbouring tiles are looked up once.
#include "mapping/ways/tile_cells.hpp"

#include <algorithm>

namespace cluxel::mapping {

TileCells::TileCells(std::vector<perception::TileKey> keys) : keys_(std::move(keys)) {
  for (const perception::TileKey& key : keys_) {
    auto& ring = ring_.emplace_back();
    const auto around = perception::ringOf(key);
    for (std::size_t i = 0; i < around.size(); ++i) {
      const auto found = std::lower_bound(keys_.begin(), keys_.end(), around[i]);
      ring[i] =
          found != keys_.end() && *found == around[i] ? static_cast<std::uint32_t>(found - keys_.begin()) : kNoCell;
    }
  }
}

std::uint32_t TileCells::stepOut(std::uint32_t slot, int x, int y) const {
  const auto beyond = [](int at) { return at < 0 ? 0 : at < kCellsPerTile ? 1 : 2; };
  const std::uint32_t tile = ring_[slot][static_cast<std::size_t>(beyond(y) * 3 + beyond(x))];
  if (tile == kNoCell) return kNoCell;
  const int column = x - (beyond(x) - 1) * kCellsPerTile, row = y - (beyond(y) - 1) * kCellsPerTile;
  return tile * kCellsOfTile + static_cast<std::uint32_t>(row * kCellsPerTile + column);
}

}  // namespace cluxel::mapping
