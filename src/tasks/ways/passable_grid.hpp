// SPDX-License-Identifier: Apache-2.0
// Which cells of the terrain a walker or robot may use, at what cost, and why others are closed.
#pragma once

#include <cstdint>
#include <vector>

#include "tasks/ways/ground_relief.hpp"
#include "tasks/ways/terrain_grid.hpp"

namespace cluxel::tasks {

enum class Closure : std::uint8_t { Open, Unobserved, Obstacle, TooSteep, TooNarrow };

struct WayParams {
  double width_m = 0.6;             ///< free width that is needed
  double max_slope = 0.12;          ///< rise over run
  double max_step_m = 0.06;         ///< height of a step, as GroundRelief has it
  bool crosses_unobserved = false;  ///< ground that was not observed is open, at unobserved_factor
  double unobserved_factor = 1.5;   ///< cost of a metre there
  double near_m = 8;                ///< how far `near` things may be without extra cost
  double far_factor = 3;            ///< cost of a metre that is farther from them
};

struct PassableGrid {
  GridFrame frame;
  LargeArray<Closure> closure;
  LargeArray<std::uint32_t> blocker;  ///< of Obstacle and TooNarrow: the object, as in TerrainGrid
  LargeArray<float> factor;           ///< cost of a metre, at least 1
  LargeArray<float> clearance_m;      ///< from the cell's centre to the nearest thing's cell
  LargeArray<float> height;           ///< of the ground [m, map]
  GroundRelief relief;
  double max_step_m = 0;

  /// The height of the step between neighbouring cells [m]; of a diagonal the largest of the four steps around its
  /// middle.
  double stepBetween(std::uint32_t a, std::uint32_t b) const;
  bool isStepOpen(std::uint32_t a, std::uint32_t b) const { return stepBetween(a, b) <= max_step_m; }
};

/// `is_left_out`: per object, true when it is to be left out. `near`: per cell, 1 where something is that the way
/// should stay near; empty: nothing.
PassableGrid passableOf(const TerrainGrid& terrain, const WayParams& params, const std::vector<bool>& is_left_out,
                        const LargeArray<std::uint8_t>& near);

/// The distance [cells] from each cell to the nearest marked one, and that cell's number; infinite and the cell itself
/// without any. Exact Euclidean distance in linear time.
struct NearestMarked {
  LargeArray<float> distance;
  LargeArray<std::uint32_t> cell;
};
NearestMarked nearestMarked(const GridFrame& frame, const LargeArray<std::uint8_t>& marked);

}  // namespace cluxel::tasks
