// SPDX-License-Identifier: Apache-2.0
// The ground of a map as a grid: its height, whether it was seen, and which objects stand in a robot's way.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/sorting/large_array.hpp"
#include "mapping/map_reader.hpp"

namespace cluxel::tasks {

/// Square cells of the map frame, numbered row by row from the corner with the smallest x and y.
struct GridFrame {
  double min_x = 0, min_y = 0;  ///< of that corner [m, map]
  double cell_m = 0.25;
  int columns = 0, rows = 0;

  std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::uint32_t index(int column, int row) const { return static_cast<std::uint32_t>(row * columns + column); }
  int columnOf(std::uint32_t cell) const { return static_cast<int>(cell) % columns; }
  int rowOf(std::uint32_t cell) const { return static_cast<int>(cell) / columns; }
  bool holds(int column, int row) const { return column >= 0 && row >= 0 && column < columns && row < rows; }
  Eigen::Vector2d centreOf(std::uint32_t cell) const {
    return {min_x + (columnOf(cell) + 0.5) * cell_m, min_y + (rowOf(cell) + 0.5) * cell_m};
  }
  /// None outside the grid.
  std::optional<std::uint32_t> cellAt(const Eigen::Vector2d& p_map) const;
};

/// The number of points that belong to no object.
inline constexpr std::uint32_t kUnnamedThing = 0xffffffffU;

struct TerrainGrid {
  GridFrame frame;
  LargeArray<float> height;               ///< of the ground [m, map]
  LargeArray<std::uint8_t> seen;          ///< 1: ground was measured here or within kSeenReach_m
  LargeArray<std::uint32_t> first_thing;  ///< per cell, the first of its things; size() + 1 entries
  LargeArray<std::uint32_t> things;  ///< numbers in MapReader::objects(), or kUnnamedThing; ascending within a cell

  std::span<const std::uint32_t> thingsIn(std::uint32_t cell) const {
    return {things.data() + first_thing[cell], things.data() + first_thing[cell + 1]};
  }
};

struct TerrainParams {
  double cell_m = 0.25;
  double lowest_m = 0.20;   ///< things below this height above the ground are steps, not obstacles
  double highest_m = 2.00;  ///< clearance: what hangs higher is no obstacle
  /// The part of the map frame that the grid covers [m, map]; absent: all tiles of the map. It may reach beyond them.
  std::optional<Eigen::AlignedBox2d> area = std::nullopt;
};
inline constexpr double kSeenReach_m = 1.0;

/// From the map's thinned points and ground surface. Objects of surface classes are no things. `is_left_out`: per
/// object, true where its points do not count for the height of the ground; empty: all points count. The things are
/// the same whatever is left out. Cost: in the points.
TerrainGrid terrainOf(const mapping::MapReader& map, const TerrainParams& params = {},
                      const std::vector<bool>& is_left_out = {});

}  // namespace cluxel::tasks
