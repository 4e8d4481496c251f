// SPDX-License-Identifier: Apache-2.0
// The middle lines of patches of cells.
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/ways/tile_cells.hpp"

namespace cluxel::mapping {

/// Distances to the edge are cut off here [cells]. Cells as far from the edge as this are never taken away: ground that
/// is wider than twice as much stays a patch.
inline constexpr int kFarthestEdge = 29;

/// The squared distance [cells] from the centre of each cell where `inside` is 1 to that of the nearest other cell, at
/// most that of kFarthestEdge; else 0. It follows from the cells within kFarthestEdge.
std::vector<std::uint16_t> squaredEdgeDistances(const TileCells& cells, const std::vector<std::uint8_t>& inside);

/// 1 for the cells of lines one cell wide that are connected as the patches are, with their holes: cells are taken away
/// from the edge inwards, by distances up to `levels` cells, less than kFarthestEdge. Lines end where the edge is
/// `end_distance2` away or more (squared, in cells). A cell's value follows from the cells within 2 * `levels`.
std::vector<std::uint8_t> skeletonOf(const TileCells& cells, const std::vector<std::uint16_t>& edge_distance2,
                                     int levels, std::uint16_t end_distance2);

}  // namespace cluxel::mapping
