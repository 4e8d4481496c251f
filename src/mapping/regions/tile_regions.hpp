// SPDX-License-Identifier: Apache-2.0
// Cuts the tiles of a map into regions, each of which fits into memory.
#pragma once

#include <cstddef>
#include <vector>

#include "perception/tile.hpp"

namespace cluxel::mapping {

struct CountedTile {
  perception::TileKey key;
  std::size_t cluxels = 0;
};

/// Tiles are halved along their longer side until each part has at most `max_cluxels`, or is a single tile. None for no
/// tiles.
std::vector<perception::TileSet> regionsOf(std::vector<CountedTile> tiles, std::size_t max_cluxels);

}  // namespace cluxel::mapping
