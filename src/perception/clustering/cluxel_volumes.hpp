// SPDX-License-Identifier: Apache-2.0
// The parts of clustering that follow the seeds: bounding volumes with their moments, and the tile's cell stacks.
#pragma once

#include "perception/clustering/cluxel_tile.hpp"
#include "perception/clustering/point_grid.hpp"

namespace cluxel::perception {

/// Fills volumes, balls and reaches: from all points within the radius of each seed or, where these are too few, within
/// the distance that holds the target number of points. Cell size: the radius (`cells`), the largest reach
/// (`wide_cells`). Of `chosen` cluxels, ascending; others get a volume that meets nothing.
void measureVolumes(const PointGrid& cells, const PointGrid& wide_cells, const TilePoints& points,
                    const ClusterParams& params, std::vector<std::uint32_t> chosen, CluxelTile& tile);

/// Moments, boxes, intensities and stacks of the points of each cluxel, from `seed` and `point_cluxel`.
void measureOwn(const TilePoints& points, CluxelTile& tile);

/// The contents of each cell stack of the tile.
std::vector<CellStack> stacksOf(const TilePoints& points);

}  // namespace cluxel::perception
