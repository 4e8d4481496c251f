// SPDX-License-Identifier: Apache-2.0
// Ways over a grid whose arrays are in files are those over the part of it that was observed.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tasks/ways/passable_grid.hpp"
#include "tasks/ways/way_search.hpp"

namespace cluxel::tasks {
namespace {

TerrainGrid randomTerrain(int columns, int rows) {
  std::mt19937 random(23);
  TerrainGrid terrain;
  terrain.frame = {-7, 3, 0.5, columns, rows};
  terrain.first_thing.push_back(0);
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell) {
    terrain.height.push_back(static_cast<float>(random() % 40) * 0.001F + (random() % 20 == 0 ? 0.3F : 0.0F));
    terrain.seen.push_back(random() % 30 == 0 ? 0 : 1);
    if (random() % 15 == 0) terrain.things.push_back(random() % 3 == 0 ? kUnnamedThing : 0);
    terrain.first_thing.push_back(static_cast<std::uint32_t>(terrain.things.size()));
  }
  return terrain;
}

/// The same with more cells, which were not observed.
TerrainGrid widened(const TerrainGrid& terrain, int columns, int rows) {
  TerrainGrid wide;
  wide.frame = terrain.frame;
  wide.frame.columns = columns, wide.frame.rows = rows;
  wide.first_thing.push_back(0);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const bool is_there = terrain.frame.holds(column, row);
      const std::uint32_t cell = is_there ? terrain.frame.index(column, row) : 0;
      wide.height.push_back(is_there ? terrain.height[cell] : 0.0F);
      wide.seen.push_back(is_there ? terrain.seen[cell] : 0);
      if (is_there)
        for (const std::uint32_t thing : terrain.thingsIn(cell)) wide.things.push_back(thing);
      wide.first_thing.push_back(static_cast<std::uint32_t>(wide.things.size()));
    }
  return wide;
}

TEST(LargeGrid, HasTheWaysOfTheSmallGridInIt) {
  const TerrainGrid terrain = randomTerrain(90, 70), wide = widened(terrain, 2100, 2050);
  ASSERT_GT(wide.frame.size() * sizeof(float), kMostBytesInMemory);
  ASSERT_LT(terrain.frame.size() * sizeof(double), kMostBytesInMemory);
  WayParams params;
  params.max_slope = 0.3;
  const std::vector<bool> none_left_out(1, false);
  const PassableGrid in_memory = passableOf(terrain, params, none_left_out, {}),
                     in_files = passableOf(wide, params, none_left_out, {});
  std::uint32_t start = 0;
  while (in_memory.closure[start] != Closure::Open) ++start;
  const auto inFiles = [&](std::uint32_t cell) {
    return wide.frame.index(terrain.frame.columnOf(cell), terrain.frame.rowOf(cell));
  };
  const CheapestWays ways = cheapestWays(in_memory, start), same = cheapestWays(in_files, inFiles(start));
  std::size_t reached = 0;
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell) {
    const std::uint32_t there = inFiles(cell);
    ASSERT_EQ(in_files.closure[there], in_memory.closure[cell]);
    EXPECT_EQ(in_files.blocker[there], in_memory.blocker[cell]);
    EXPECT_EQ(in_files.factor[there], in_memory.factor[cell]);
    EXPECT_EQ(in_files.relief.step_east[there], in_memory.relief.step_east[cell]);
    EXPECT_EQ(same.cost[there], ways.cost[cell]);
    EXPECT_EQ(same.before[there], inFiles(ways.before[cell])) << "ties are broken alike";
    reached += std::isfinite(ways.cost[cell]) ? 1 : 0;
  }
  EXPECT_GT(reached, terrain.frame.size() / 4);
}

}  // namespace
}  // namespace cluxel::tasks
