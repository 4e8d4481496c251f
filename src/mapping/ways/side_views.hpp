// SPDX-License-Identifier: Apache-2.0
// How wide a way is at the cells of its middle line, and what lies beyond its edges.
#pragma once

#include <vector>

#include "mapping/ways/even_ground.hpp"
#include "mapping/ways/way_tile.hpp"

namespace cluxel::mapping {

inline constexpr int kSeenAlong = 6;  ///< the direction of a line follows from so many cells to both sides

/// Looks both ways across the line `skeleton` from a cell of it, up to kFarthestSide_m.
AcrossWay acrossFrom(const GroundCells& ground, const std::vector<std::uint8_t>& skeleton, std::uint32_t cell);

}  // namespace cluxel::mapping
