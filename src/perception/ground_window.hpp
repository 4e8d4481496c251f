// SPDX-License-Identifier: Apache-2.0
// The square of cells over which the ground of one tile is worked out: the tile's columns and its ring's.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace cluxel {

/// Heights of the cells of a square window, some of them unknown: those are not a number, so that no comparison holds
/// there and whole rows are worked through without a branch.
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

/// Forgets cells that lie alone and far below what is around them: reflections seem to come from under the ground.
void dropSunkenCells(HeightWindow& window, double cell_m, double steepest, double step_m);

/// Forgets cells that rise more than `step_m` above the lowest cone of slope `steepest` through any other cell.
void dropRaisedCells(HeightWindow& window, double cell_m, double steepest, double step_m);

/// A height for every cell: known ones stay, others follow from the known ones around them, nearer ones first
/// (averages of ever coarser cells, brought back by bilinear interpolation). At least one cell must be known.
std::vector<float> filled(const HeightWindow& window);

/// Mean over the square of 2 * `reach` + 1 cells around each cell, as far as it lies in the window.
std::vector<float> smoothed(const std::vector<float>& height, int side, int reach);

}  // namespace cluxel
