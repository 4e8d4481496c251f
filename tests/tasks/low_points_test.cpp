// SPDX-License-Identifier: Apache-2.0
// Heights of cells from the points near them, against a search among all points.
#include "tasks/ways/low_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace cluxel::tasks {
namespace {

struct PlacedPoint {
  std::uint32_t cell;
  Eigen::Vector3d p_map;
};

/// A sloping surface with holes; the frame has several bands of rows.
TerrainGrid slopingGrid(double cell_m) {
  TerrainGrid grid;
  grid.frame = {-3, 5, cell_m, 9, 150};
  for (std::uint32_t cell = 0; cell < grid.frame.size(); ++cell) {
    grid.height.push_back(static_cast<float>(0.1 * grid.frame.centreOf(cell).y()));
    grid.seen.push_back(cell % 7 == 0 ? 0 : 1);
    if (cell % 53 == 0) grid.height.back() = std::numeric_limits<float>::quiet_NaN();
  }
  return grid;
}

/// Points are dense in some rows and rare in others.
std::vector<PlacedPoint> randomPoints(const GridFrame& frame, std::mt19937& random) {
  std::vector<PlacedPoint> points;
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  for (std::uint32_t cell = 0; cell < frame.size(); ++cell)
    for (unsigned i = 0; i < random() % (frame.rowOf(cell) % 3 == 0 ? 7 : 2); ++i) {
      const Eigen::Vector2d at =
          frame.centreOf(cell) + 0.99 * frame.cell_m * Eigen::Vector2d(within(random), within(random));
      points.push_back({cell, {at.x(), at.y(), 0.1 * at.y() + 0.1 * within(random)}});
    }
  std::shuffle(points.begin(), points.end(), random);
  return points;
}

void refine(TerrainGrid& grid, const std::vector<PlacedPoint>& points, std::size_t in_memory) {
  LowPoints low(grid.frame, in_memory);
  for (const PlacedPoint& point : points) low.add(point.cell, point.p_map);
  for (std::uint32_t cell = 0; cell < grid.frame.size(); cell += 11) low.addLeftOut(cell);
  low.refine(grid);
}

bool isSame(float a, float b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

TEST(LowPoints, GiveTheSameHeightsInAnyOrderAndFromAFile) {
  std::mt19937 random(5);
  for (const double cell_m : {0.1, 0.25, 2.0}) {
    TerrainGrid expected = slopingGrid(cell_m);
    std::vector<PlacedPoint> points = randomPoints(expected.frame, random);
    const TerrainGrid before = expected;
    refine(expected, points, points.size() + 1);
    for (const std::size_t in_memory : {std::size_t{1}, std::size_t{100}, points.size() / 2}) {
      TerrainGrid grid = before;
      std::shuffle(points.begin(), points.end(), random);
      refine(grid, points, in_memory);
      for (std::uint32_t cell = 0; cell < grid.frame.size(); ++cell)
        EXPECT_TRUE(isSame(grid.height[cell], expected.height[cell])) << cell << ", " << in_memory << " in memory";
    }
  }
}

TEST(LowPoints, GiveAFlatCellTheMedianOfTheNearestThreeOrMore) {
  std::mt19937 random(6);
  TerrainGrid grid = slopingGrid(0.25);
  for (float& height : grid.height) height = 0;
  const std::vector<PlacedPoint> points = randomPoints(grid.frame, random);
  const GridFrame frame = grid.frame;
  refine(grid, points, 100);
  std::size_t told = 0;
  for (std::uint32_t cell = 0; cell < frame.size(); ++cell) {
    std::vector<float> heights;
    for (int ring = 0; ring <= 2 && heights.size() < (cell % 11 == 0 ? 8U : 3U); ++ring) {
      heights.clear();
      for (const PlacedPoint& point : points)
        if (std::abs(frame.columnOf(point.cell) - frame.columnOf(cell)) <= ring &&
            std::abs(frame.rowOf(point.cell) - frame.rowOf(cell)) <= ring)
          heights.push_back(static_cast<float>(point.p_map.z()));
    }
    std::sort(heights.begin(), heights.end());
    const bool is_told = grid.seen[cell] != 0 && heights.size() >= 3;
    const std::size_t rank = heights.size() / (cell % 11 == 0 && heights.size() >= 8 ? 4 : 2);
    EXPECT_EQ(grid.height[cell], is_told ? heights[rank] : 0.0F) << cell;
    told += is_told ? 1 : 0;
  }
  EXPECT_GT(told, frame.size() / 2);
}

}  // namespace
}  // namespace cluxel::tasks
