// SPDX-License-Identifier: Apache-2.0
// Slopes and steps of the ground. A step is a rise within half a metre that stands out from the ground on both sides of
// it; all else that rises is a slope.
#pragma once

#include <vector>

#include "tasks/ways/terrain_grid.hpp"

namespace cluxel::tasks {

/// Values for each cell.
struct GroundRelief {
  LargeArray<float> slope;       ///< rise over run over a metre (two cells, when these are longer), without steps
  LargeArray<float> step_east;   ///< height of the step to the neighbour with the next x [m]; 0 without one
  LargeArray<float> step_north;  ///< the same to the neighbour with the next y
};

/// Neither slopes nor steps are told where the ground of a cell, or of its neighbour, was not observed. A step of less
/// than 5 cm counts for the slope, too. Cost: O(cells times those of half a metre).
GroundRelief reliefOf(const TerrainGrid& terrain);

}  // namespace cluxel::tasks
