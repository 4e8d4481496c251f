// SPDX-License-Identifier: Apache-2.0
// Even ground of a tile where things stood that are gone: what they left in the points does not count.
#pragma once

#include <cstdint>
#include <vector>

#include "perception/features/even_tile.hpp"

namespace cluxel::mapping {

/// By point of a tile: the number of the gone thing that it is of, or kNotGone. A thing has one number in all tiles of
/// a ring.
using GonePoints = std::vector<std::uint32_t>;
inline constexpr std::uint32_t kNotGone = 0xFFFFFFFFU;

/// evenGroundOf() without the points of gone things. In a cell with such points up to perception::kThingTop_m above the
/// ground the low points of the scans that measured the thing do not count either: ground cluxels hold points of its
/// foot, and the scan saw little ground there. `gone` is null where no thing of the tile is gone. Cost: that of
/// evenGroundOf(), and of copies of tiles with gone things.
perception::EvenTile freedGroundOf(const perception::Ring<perception::TilePoints>& points,
                                   const perception::Ring<perception::GroundTile>& ground,
                                   const perception::Ring<GonePoints>& gone);

}  // namespace cluxel::mapping
