// SPDX-License-Identifier: Apache-2.0
// The square window of cells from which the ground of one tile is computed: the tile and its ring.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace cluxel::perception {

/// Heights of the cells of a square window. Unknown heights are NaN, so that no comparison holds and whole rows are
/// processed without branches.
struct HeightWindow {
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  int side = 0;               ///< cells along an edge
  std::vector<float> height;  ///< [m], or kUnknown

  explicit HeightWindow(int cells_along_edge = 0)
      : side(cells_along_edge), height(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), kUnknown) {}
  std::size_t size() const { return height.size(); }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x);
  }
  bool knows(std::size_t cell) const { return !std::isnan(height[cell]); }
};

/// Clears isolated cells far below their surroundings: mirror reflections appear below the ground.
void dropSunkenCells(HeightWindow& window, double cell_m, double steepest, double step_m);

/// Clears cells that rise more than `step_m` above the lowest cone of slope `steepest` through any other cell.
void dropRaisedCells(HeightWindow& window, double cell_m, double steepest, double step_m);

/// A height for every cell: known cells keep theirs, others are interpolated from the nearest known ones (push-pull
/// over a pyramid of averages). At least one cell must be known.
std::vector<float> filled(const HeightWindow& window);

/// Mean over the square of 2 * `reach` + 1 cells around each cell, clipped to the window.
std::vector<float> smoothed(const std::vector<float>& height, int side, int reach);

}  // namespace cluxel::perception
