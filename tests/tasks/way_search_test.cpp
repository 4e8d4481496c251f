// SPDX-License-Identifier: Apache-2.0
// The search gives the ways of Boost's, cell by cell, also where many ways cost the same.
#include "tasks/ways/way_search.hpp"

#include <gtest/gtest.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>

namespace cluxel::tasks {
namespace {

using Cell = std::uint32_t;
using EdgeCost = boost::property<boost::edge_weight_t, double>;
using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, boost::no_property, EdgeCost>;

/// Few factors and steps, so that costs are often equal.
PassableGrid randomGrid(std::mt19937& random) {
  PassableGrid grid;
  grid.frame = {0, 0, 0.25, static_cast<int>(2 + random() % 25), static_cast<int>(2 + random() % 25)};
  grid.max_step_m = 0.06;
  const unsigned factors = 1 + random() % 3;
  for (Cell cell = 0; cell < grid.frame.size(); ++cell) {
    grid.closure.push_back(random() % 5 == 0 ? Closure::Obstacle : Closure::Open);
    grid.factor.push_back(1.0F + 0.5F * static_cast<float>(random() % factors));
    grid.relief.step_east.push_back(random() % 12 == 0 ? 0.1F : 0.0F);
    grid.relief.step_north.push_back(random() % 12 == 0 ? 0.1F : 0.0F);
  }
  return grid;
}

double costOfStep(const PassableGrid& grid, const SearchRules& rules, Cell from, Cell to, bool is_diagonal) {
  const double metre = rules.is_priced ? (double{grid.factor[from]} + double{grid.factor[to]}) / 2 : 1.0;
  const double free = grid.frame.cell_m * (is_diagonal ? std::sqrt(2.0) : 1.0) * metre;
  const int closed = (grid.closure[to] == Closure::Open ? 0 : 1) + (grid.isStepOpen(from, to) ? 0 : 1);
  return closed == 0 ? free : free + closed * *rules.closed_cost;
}

Graph graphOf(const PassableGrid& grid, const SearchRules& rules) {
  const GridFrame& frame = grid.frame;
  const auto isOpen = [&](int x, int y) { return grid.closure[frame.index(x, y)] == Closure::Open; };
  Graph graph(frame.size());
  for (Cell from = 0; from < frame.size(); ++from)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int x = frame.columnOf(from), y = frame.rowOf(from);
        if ((dx == 0 && dy == 0) || !frame.holds(x + dx, y + dy)) continue;
        if (dx != 0 && dy != 0 && !(isOpen(x + dx, y) && isOpen(x, y + dy))) continue;
        const Cell to = frame.index(x + dx, y + dy);
        if (!rules.closed_cost && !(isOpen(x + dx, y + dy) && grid.isStepOpen(from, to))) continue;
        boost::add_edge(from, to, costOfStep(grid, rules, from, to, dx != 0 && dy != 0), graph);
      }
  return graph;
}

CheapestWays waysOfBoost(const Graph& graph, Cell start) {
  const std::size_t count = boost::num_vertices(graph);
  CheapestWays ways{LargeArray<double>(count, std::numeric_limits<double>::infinity()), LargeArray<Cell>(count)};
  std::iota(ways.before.begin(), ways.before.end(), 0U);
  ways.cost[start] = 0;
  const boost::typed_identity_property_map<Cell> index;
  boost::dijkstra_shortest_paths_no_init(graph, start, boost::make_iterator_property_map(ways.before.begin(), index),
                                         boost::make_iterator_property_map(ways.cost.begin(), index),
                                         boost::get(boost::edge_weight, graph), index, std::less<double>(),
                                         std::plus<double>(), 0.0, boost::default_dijkstra_visitor());
  return ways;
}

TEST(WaySearch, BreaksTiesAsBoostDoes) {
  std::mt19937 random(1);
  std::size_t reached = 0, tied = 0;
  for (int round = 0; round < 200; ++round) {
    PassableGrid grid = randomGrid(random);
    const Cell start = static_cast<Cell>(random() % grid.frame.size());
    grid.closure[start] = Closure::Open;
    SearchRules rules;
    rules.is_priced = random() % 2 == 0;
    if (random() % 3 == 0) rules.closed_cost = 2.5;
    const Graph graph = graphOf(grid, rules);
    const CheapestWays ways = cheapestWays(grid, start, rules), expected = waysOfBoost(graph, start);
    ASSERT_EQ(ways.cost, expected.cost) << round;
    ASSERT_EQ(ways.before, expected.before) << round;
    for (const auto edge : boost::make_iterator_range(boost::edges(graph))) {
      const auto from = static_cast<Cell>(source(edge, graph)), to = static_cast<Cell>(target(edge, graph));
      const double cost = ways.cost[from] + boost::get(boost::edge_weight, graph, edge);
      if (std::isfinite(cost) && ways.before[to] != from && cost == ways.cost[to]) ++tied;
    }
    for (const double cost : ways.cost) reached += std::isfinite(cost) ? 1 : 0;
  }
  EXPECT_GT(reached, 10'000U);
  EXPECT_GT(tied, 1'000U);
}

}  // namespace
}  // namespace cluxel::tasks
