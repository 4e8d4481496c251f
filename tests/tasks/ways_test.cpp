// SPDX-License-Identifier: Apache-2.0
// Ways over small grids against brute force: distances, costs, routes, barriers, cost maps.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "cluxel/error.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/ways/cost_map.hpp"
#include "tasks/ways/route.hpp"
#include "tasks/ways/way_search.hpp"

namespace cluxel::tasks {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A flat, observed terrain; `rows` from the largest y down: '#' a thing numbered 0, '?' unobserved, '^' 0.3 m higher.
TerrainGrid terrainFrom(const std::vector<std::string>& rows, double cell_m = 1) {
  TerrainGrid terrain;
  terrain.frame = {0, 0, cell_m, static_cast<int>(rows.front().size()), static_cast<int>(rows.size())};
  terrain.first_thing.push_back(0);
  for (std::size_t y = rows.size(); y-- > 0;)
    for (const char c : rows[y]) {
      terrain.height.push_back(c == '^' ? 0.3F : 0.0F);
      terrain.seen.push_back(c == '?' ? 0 : 1);
      if (c == '#') terrain.things.push_back(0);
      terrain.first_thing.push_back(static_cast<std::uint32_t>(terrain.things.size()));
    }
  return terrain;
}

PassableGrid passable(const TerrainGrid& terrain, double width_m = 0, bool is_gone = false) {
  WayParams params;
  params.width_m = width_m;
  return passableOf(terrain, params, {is_gone}, {});
}

TerrainGrid randomTerrain(std::mt19937& random, int columns, int rows) {
  std::vector<std::string> text(static_cast<std::size_t>(rows), std::string(static_cast<std::size_t>(columns), '.'));
  for (std::string& line : text)
    for (char& c : line) c = "....##^?"[random() % 8];
  return terrainFrom(text);
}

TEST(NearestMarked, GivesTheDistancesOfAllPairs) {
  std::mt19937 random(2);
  for (int round = 0; round < 60; ++round) {
    const GridFrame frame{0, 0, 1, 1 + static_cast<int>(random() % 12), 1 + static_cast<int>(random() % 12)};
    LargeArray<std::uint8_t> marked(frame.size());
    for (std::uint8_t& mark : marked) mark = random() % 6 == 0 ? 1 : 0;
    const NearestMarked nearest = nearestMarked(frame, marked);
    for (std::uint32_t a = 0; a < frame.size(); ++a) {
      double best = kNever;
      for (std::uint32_t b = 0; b < frame.size(); ++b)
        if (marked[b] != 0) best = std::min(best, (frame.centreOf(a) - frame.centreOf(b)).norm());
      if (std::isinf(best)) {
        EXPECT_TRUE(std::isinf(nearest.distance[a]));
        continue;
      }
      EXPECT_NEAR(nearest.distance[a], best, 1e-5);
      EXPECT_EQ(marked[nearest.cell[a]], 1);
      EXPECT_NEAR((frame.centreOf(a) - frame.centreOf(nearest.cell[a])).norm(), best, 1e-5);
    }
  }
}

/// Costs by relaxing all edges until nothing changes.
LargeArray<double> relaxed(const PassableGrid& grid, std::uint32_t start) {
  LargeArray<double> cost(grid.frame.size(), kNever);
  const auto isOpen = [&](int x, int y) {
    return grid.frame.holds(x, y) && grid.closure[grid.frame.index(x, y)] == Closure::Open;
  };
  if (grid.closure[start] == Closure::Open) cost[start] = 0;
  for (bool is_changed = true; is_changed;) {
    is_changed = false;
    for (std::uint32_t a = 0; a < grid.frame.size(); ++a)
      for (std::uint32_t b = 0; b < grid.frame.size(); ++b) {
        const int ax = grid.frame.columnOf(a), ay = grid.frame.rowOf(a), bx = grid.frame.columnOf(b),
                  by = grid.frame.rowOf(b);
        if (a == b || std::abs(ax - bx) > 1 || std::abs(ay - by) > 1) continue;
        if (!isOpen(ax, ay) || !isOpen(bx, by) || !isOpen(ax, by) || !isOpen(bx, ay)) continue;
        if (!grid.isStepOpen(a, b)) continue;
        const double edge = std::hypot(ax - bx, ay - by) *
                            (static_cast<double>(grid.factor[a]) + static_cast<double>(grid.factor[b])) / 2;
        if (cost[a] + edge < cost[b] - 1e-12) {
          cost[b] = cost[a] + edge;
          is_changed = true;
        }
      }
  }
  return cost;
}

TEST(WaySearch, FindsTheCostsOfRelaxingAllEdges) {
  std::mt19937 random(11);
  int reached = 0;
  for (int round = 0; round < 40; ++round) {
    const PassableGrid grid = passable(randomTerrain(random, 7, 6));
    const auto start = static_cast<std::uint32_t>(random() % grid.frame.size());
    const LargeArray<double> expected = relaxed(grid, start);
    const CheapestWays ways = cheapestWays(grid, start);
    for (std::uint32_t cell = 0; cell < grid.frame.size(); ++cell) {
      ASSERT_EQ(std::isinf(ways.cost[cell]), std::isinf(expected[cell]));
      if (std::isinf(expected[cell])) continue;
      EXPECT_NEAR(ways.cost[cell], expected[cell], 1e-9);
      const std::vector<std::uint32_t> way = wayTo(ways, cell);
      EXPECT_EQ(way.front(), start);
      EXPECT_EQ(way.back(), cell);
      EXPECT_NEAR(cheapestWays(grid, start, {.goal = cell}).cost[cell], expected[cell], 1e-9);
      ++reached;
    }
  }
  EXPECT_GT(reached, 100);
}

TEST(PassableGrid, ClosesThingsNarrowPlacesAndWhatWasNotObserved) {
  const TerrainGrid terrain = terrainFrom({"...?", ".#..", "...."});
  const PassableGrid wide = passable(terrain, 2.5), thin = passable(terrain), gone = passable(terrain, 2.5, true);
  const std::uint32_t thing = wide.frame.index(1, 1), beside = wide.frame.index(2, 1), dark = wide.frame.index(3, 2);
  EXPECT_EQ(thin.closure[thing], Closure::Obstacle);
  EXPECT_EQ(thin.closure[beside], Closure::Open);
  EXPECT_EQ(wide.closure[beside], Closure::TooNarrow);
  EXPECT_EQ(wide.blocker[beside], 0U);
  EXPECT_EQ(wide.closure[wide.frame.index(3, 0)], Closure::Open);
  EXPECT_EQ(wide.closure[dark], Closure::Unobserved);
  EXPECT_EQ(gone.closure[thing], Closure::Open) << "left out";
  EXPECT_EQ(gone.closure[beside], Closure::Open);
}

TEST(PassableGrid, ARampIsASlopeAndAKerbIsAStep) {
  TerrainGrid ramp = terrainFrom({std::string(40, '.'), std::string(40, '.'), std::string(40, '.')}, 0.25);
  for (std::uint32_t cell = 0; cell < ramp.frame.size(); ++cell)
    ramp.height[cell] = 0.05F * static_cast<float>(ramp.frame.columnOf(cell));
  const PassableGrid steep = passable(ramp);
  EXPECT_NEAR(steep.relief.slope[steep.frame.index(20, 1)], 0.2, 1e-3);
  EXPECT_EQ(steep.closure[steep.frame.index(20, 1)], Closure::TooSteep);
  for (std::uint32_t cell = 0; cell < ramp.frame.size(); ++cell)
    ramp.height[cell] = ramp.frame.columnOf(cell) < 20 ? 0.0F : 0.12F;
  const PassableGrid kerb = passable(ramp);
  EXPECT_NEAR(kerb.relief.slope[kerb.frame.index(20, 1)], 0, 1e-6);
  EXPECT_FALSE(kerb.isStepOpen(kerb.frame.index(19, 1), kerb.frame.index(20, 1)));
  const RouteAnswer answer = findRoutes(kerb, {1, 0.4}, {9, 0.4}, 1);
  EXPECT_TRUE(answer.routes.empty());
  ASSERT_EQ(answer.barriers.size(), 1U);
  EXPECT_EQ(answer.barriers[0].kind, Barrier::Kind::Step);
  EXPECT_NEAR(answer.barriers[0].measured, 0.12, 1e-6);
  EXPECT_NEAR(answer.barriers[0].at.x(), 5, 0.2);
}

TEST(Routes, GoAroundAndTellWhatIsInTheWay) {
  const TerrainGrid open = terrainFrom({".......", ".#####.", ".......", "......."});
  const PassableGrid grid = passable(open);
  const RouteAnswer around = findRoutes(grid, {3.5, 3.5}, {3.5, 1.5}, 1);
  ASSERT_EQ(around.routes.size(), 1U);
  EXPECT_TRUE(around.barriers.empty());
  for (const std::uint32_t cell : around.routes[0].cells) EXPECT_EQ(grid.closure[cell], Closure::Open);
  EXPECT_NEAR(around.routes[0].cost, relaxed(grid, grid.frame.index(3, 3))[grid.frame.index(3, 1)], 1e-6);
  EXPECT_GE(around.routes[0].length_m, 8);

  const PassableGrid wall = passable(terrainFrom({".......", "#######", "......."}));
  const RouteAnswer closed = findRoutes(wall, {3.5, 2.5}, {3.5, 0.5}, 2);
  EXPECT_TRUE(closed.routes.empty());
  ASSERT_EQ(closed.barriers.size(), 1U);
  EXPECT_EQ(closed.barriers[0].kind, Barrier::Kind::Obstacle);
  EXPECT_EQ(closed.barriers[0].thing, 0U);
  EXPECT_EQ(findRoutes(passable(terrainFrom({".......", "#######", "......."}), 0, true), {3.5, 2.5}, {3.5, 0.5}, 1)
                .routes.size(),
            1U);
}

TEST(Routes, ThereIsAlwaysARouteOrSomethingInTheWay) {
  std::mt19937 random(23);
  int closed = 0;
  for (int round = 0; round < 60; ++round) {
    const PassableGrid grid = passable(randomTerrain(random, 6, 6));
    const auto start = static_cast<std::uint32_t>(random() % grid.frame.size());
    const auto goal = static_cast<std::uint32_t>(random() % grid.frame.size());
    if (grid.closure[start] != Closure::Open || grid.closure[goal] != Closure::Open) continue;
    const RouteAnswer answer = findRoutes(grid, grid.frame.centreOf(start), grid.frame.centreOf(goal), 1);
    EXPECT_EQ(answer.routes.empty(), std::isinf(relaxed(grid, start)[goal]));
    EXPECT_EQ(answer.barriers.empty(), !answer.routes.empty());
    closed += answer.routes.empty() ? 1 : 0;
  }
  EXPECT_GT(closed, 3);
}

TEST(Routes, AlternativesDifferAndAreSortedByCost) {
  const TerrainGrid two_ways =
      terrainFrom({"...............", "...............", "...#########...", "...#########...", "...#########...",
                   "...#########...", "...............", "..............."});
  const RouteAnswer answer = findRoutes(passable(two_ways), {0.5, 3.5}, {14.5, 4.5}, 3);
  ASSERT_GE(answer.routes.size(), 2U);
  EXPECT_LE(answer.routes[0].cost, answer.routes[1].cost);
  EXPECT_NE(answer.routes[0].cells, answer.routes[1].cells);
}

TEST(Routes, PlacesFarFromOpenGroundAreRefused) {
  const PassableGrid grid = passable(terrainFrom({"?????????", "?????????", "?????????", "........."}));
  EXPECT_THROW(findRoutes(grid, {4.5, 3.5}, {1, 0.5}, 1), Error);
  EXPECT_THROW(findRoutes(grid, {99, 0}, {1, 0.5}, 1), Error);
  EXPECT_EQ(findRoutes(grid, {4.5, 1.5}, {1, 0.5}, 1).routes.size(), 1U) << "moved to the nearest open cell";
}

TEST(Walks, EndAtTheirReachAndFindWhatStandsBeside) {
  const TerrainGrid terrain = terrainFrom({"..........", "........#.", ".........."});
  const LargeArray<double> far = walkLengths(passable(terrain), {0.5, 1.5}, 7.5);
  for (std::uint32_t cell = 0; cell < far.size(); ++cell) EXPECT_TRUE(std::isinf(far[cell]) || far[cell] <= 7.5);
  EXPECT_NEAR(far[terrain.frame.index(7, 1)], 7, 1e-9);
  const auto reached = objectsWithin(terrain, far, {false});
  ASSERT_EQ(reached.size(), 1U);
  EXPECT_EQ(reached[0].object, 0U);
  EXPECT_NEAR(reached[0].walk_m, 7, 1e-9);
  EXPECT_TRUE(objectsWithin(terrain, walkLengths(passable(terrain), {0.5, 1.5}, 3), {false}).empty());
}

TEST(CostMap, IsAnImageFromTheTopWithItsPlaceInYaml) {
  TerrainGrid terrain = terrainFrom({".?", "#."}, 0.5);
  terrain.frame.min_x = -3;
  terrain.frame.min_y = 7.25;
  const CostMap map = costMapOf(passable(terrain), "site.pgm");
  EXPECT_EQ(map.image, std::string("P5\n2 2\n255\n\xfe\xcd\x00\xfe", 15));
  EXPECT_NE(map.yaml.find("image: \"site.pgm\"\nresolution: 0.5\norigin: [-3.000, 7.250, 0.0]\n"), std::string::npos)
      << map.yaml;
}

}  // namespace
}  // namespace cluxel::tasks
