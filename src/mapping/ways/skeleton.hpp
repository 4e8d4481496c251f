// SPDX-License-Identifier: Apache-2.0
// The middle lines of patches of cells.
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/ways/tile_cells.hpp"

namespace cluxel::mapping {

inline constexpr int kFarthestEdge = 40;  ///< distances to the edge are cut off here [cells]

/// The squared distance [cells] from the centre of each cell where `inside` is 1 to that of the nearest other cell, at
/// most that of kFarthestEdge; else 0.
std::vector<std::uint16_t> squaredEdgeDistances(const TileCells& cells, const std::vector<std::uint8_t>& inside);

/// 1 for the cells of lines one cell wide that are connected as the patches are, with their holes: cells are taken away
/// from the edge inwards. Lines end where the edge is `end_distance2` away or more (squared, in cells).
std::vector<std::uint8_t> skeletonOf(const TileCells& cells, const std::vector<std::uint16_t>& edge_distance2,
                                     std::uint16_t end_distance2);

}  // namespace cluxel::mapping
