// SPDX-License-Identifier: Apache-2.0
// Which cells are seen from which: what stands higher than the eye hides what is behind it.
#pragma once

#include <cstdint>
#include <vector>

#include "tasks/ways/terrain_grid.hpp"

namespace cluxel::tasks {

struct SightGrid {
  GridFrame frame;
  LargeArray<std::uint8_t> opaque;  ///< per cell, 1: what is in it hides what is behind it
};

/// Opaque are the cells of objects whose top is at least `eye_m` above their ground, but for those that are left out.
/// Crowns above TerrainParams::highest_m, and what belongs to no object, hide nothing. `is_left_out`: per object, as
/// leftOut().
SightGrid sightOf(const mapping::MapReader& map, const TerrainGrid& terrain, const std::vector<bool>& is_left_out,
                  double eye_m);

/// The cells within `view_m` to which no opaque cell bars the straight way, with the first opaque ones, ascending. Rays
/// go to each cell on the edge of a square around the cell. Cost: O((view_m / cell_m)^2), and at most that of the grid.
std::vector<std::uint32_t> visibleFrom(const SightGrid& sight, std::uint32_t cell, double view_m);
/// The same from a place, which may lie outside of the grid.
std::vector<std::uint32_t> visibleFrom(const SightGrid& sight, const Eigen::Vector2d& p_map, double view_m);

}  // namespace cluxel::tasks
