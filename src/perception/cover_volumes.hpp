// SPDX-License-Identifier: Apache-2.0
// The parts of the cover that follow the seeds: bounding volumes with their balls, and the tile's columns.
#pragma once

#include "cluxel/perception/cluxel_tile.hpp"
#include "perception/point_grid.hpp"

namespace cluxel {

/// Fills volumes, balls and reaches: all points within the radius of each seed, or, where they are too few, within the
/// distance of the wanted number of points. `cells` has cells of the radius, `wide_cells` of the largest reach.
void measureVolumes(const PointGrid& cells, const PointGrid& wide_cells, const TilePoints& points,
                    const CoverParams& params, CluxelTile& tile);

/// What stands in each column of the tile.
std::vector<Column> columnsOf(const TilePoints& points);

}  // namespace cluxel
