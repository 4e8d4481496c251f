// SPDX-License-Identifier: Apache-2.0
// Even ground of a tile where things stood that are gone: what they left in the points does not count.
#pragma once

#include <cstdint>
#include <vector>

#include "perception/features/even_tile.hpp"

namespace cluxel::mapping {

/// By point of a tile: 1 when it is of a thing that is gone.
using GonePoints = std::vector<std::uint8_t>;

/// evenGroundOf() without the points of gone things. In a cell with such points up to perception::kThingTop_m above the
/// ground the ground holds points of their feet, too: of eight low points or more those do not count that lie more than
/// perception::kLargestNoise_m above their lower quartile. `gone` is null where nothing of the tile is gone. Cost: that
/// of evenGroundOf(), and of copies of tiles with gone things.
perception::EvenTile freedGroundOf(const perception::Ring<perception::TilePoints>& points,
                                   const perception::Ring<perception::GroundTile>& ground,
                                   const perception::Ring<GonePoints>& gone);

}  // namespace cluxel::mapping
