// SPDX-License-Identifier: Apache-2.0
// The usable cells as an implicit graph, and Dijkstra's algorithm on it with Boost's queue. That of Boost.Graph holds
// eight more bytes a cell, which cannot be elsewhere than in memory.
#include "tasks/ways/way_search.hpp"

#include <algorithm>
#include <array>
#include <boost/graph/detail/d_ary_heap.hpp>
#include <boost/property_map/property_map.hpp>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>

namespace cluxel::tasks {

namespace {

using Cell = std::uint32_t;

struct CellStep {
  Cell to = 0;
  double cost = 0;
};

/// The steps from a cell, of which there are eight at most.
struct CellSteps {
  std::array<CellStep, 8> step;
  std::size_t count = 0;
};

/// The cells of a grid as a graph. Edges are told when they are asked for: to hold them takes 200 bytes a cell.
class CellGraph {
 public:
  CellGraph(const PassableGrid& grid, const SearchRules& rules) : grid_(grid), rules_(rules) {}

  std::size_t size() const { return grid_.frame.size(); }
  bool mayUse(Cell cell) const { return isOpen(cell) || rules_.closed_cost; }

  /// To each neighbour that may be entered, row by row.
  CellSteps stepsFrom(Cell from) const {
    const GridFrame& frame = grid_.frame;
    const int x = frame.columnOf(from), y = frame.rowOf(from);
    CellSteps steps;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || !frame.holds(x + dx, y + dy)) continue;
        const Cell to = frame.index(x + dx, y + dy);
        const bool is_diagonal = dx != 0 && dy != 0;
        // A diagonal step needs both cells beside it, also on a way that may cross closed cells.
        if (!mayUse(to) || (is_diagonal && !(isOpen(frame.index(x + dx, y)) && isOpen(frame.index(x, y + dy)))))
          continue;
        if (!grid_.isStepOpen(from, to) && !rules_.closed_cost) continue;
        steps.step[steps.count++] = {to, costOf(from, to, is_diagonal)};
      }
    return steps;
  }

 private:
  bool isOpen(Cell cell) const { return grid_.closure[cell] == Closure::Open; }

  double costOf(Cell from, Cell to, bool is_diagonal) const {
    const double length_m = grid_.frame.cell_m * (is_diagonal ? std::sqrt(2.0) : 1.0);
    const double factor =
        rules_.is_priced ? (static_cast<double>(grid_.factor[from]) + static_cast<double>(grid_.factor[to])) / 2 : 1.0;
    const int closed = (isOpen(to) ? 0 : 1) + (grid_.isStepOpen(from, to) ? 0 : 1);
    return length_m * factor + (closed > 0 ? closed * *rules_.closed_cost : 0.0);
  }

  const PassableGrid& grid_;
  const SearchRules& rules_;
};

}  // namespace

CheapestWays cheapestWays(const PassableGrid& grid, std::uint32_t start, const SearchRules& rules) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const CellGraph graph(grid, rules);
  CheapestWays ways{LargeArray<double>(graph.size(), infinite), LargeArray<Cell>(graph.size())};
  std::iota(ways.before.begin(), ways.before.end(), 0U);
  if (!graph.mayUse(start)) return ways;
  LargeArray<std::uint32_t> place_in_queue(graph.size(), 0);
  const boost::typed_identity_property_map<Cell> index;
  auto cost = boost::make_iterator_property_map(ways.cost.begin(), index);
  auto place = boost::make_iterator_property_map(place_in_queue.begin(), index);
  boost::d_ary_heap_indirect<Cell, 4, decltype(place), decltype(cost), std::less<double>> queue(cost, place);
  ways.cost[start] = 0;
  queue.push(start);
  while (!queue.empty()) {
    const Cell from = queue.top();
    queue.pop();
    if (from == rules.goal) break;
    const CellSteps steps = graph.stepsFrom(from);
    for (std::size_t i = 0; i < steps.count; ++i) {
      const auto& [to, step_cost] = steps.step[i];
      const double before = ways.cost[to], now = ways.cost[from] + step_cost;
      if (!(now < before)) continue;  // so it is for cells that left the queue, too: no step has a negative cost
      ways.cost[to] = now;
      ways.before[to] = from;
      std::isinf(before) ? queue.push(to) : queue.update(to);
    }
  }
  return ways;
}

std::vector<std::uint32_t> wayTo(const CheapestWays& ways, std::uint32_t goal) {
  if (!std::isfinite(ways.cost[goal])) return {};
  std::vector<std::uint32_t> way{goal};
  while (ways.before[way.back()] != way.back()) way.push_back(ways.before[way.back()]);
  std::reverse(way.begin(), way.end());
  return way;
}

}  // namespace cluxel::tasks
