// SPDX-License-Identifier: Apache-2.0
// Dijkstra's algorithm on the usable cells, with a heap of Boost.
#include "tasks/ways/way_search.hpp"

#include <algorithm>
#include <boost/graph/detail/d_ary_heap.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

namespace cluxel::tasks {

namespace {

/// What a cell is to a search.
enum class Visited : std::uint8_t { No, Waiting, Done };

/// Steps between cells that may be used. They are told when they are asked for: a graph of them takes 200 bytes a cell.
class CellSteps {
 public:
  CellSteps(const PassableGrid& grid, const SearchRules& rules) : grid_(grid), rules_(rules) {}

  bool mayUse(std::uint32_t cell) const { return isOpen(cell) || rules_.closed_cost; }

  /// Calls `visit(to, cost)` for each neighbour that may be entered, row by row.
  template <typename Visit>
  void forEachFrom(std::uint32_t from, const Visit& visit) const {
    const GridFrame& frame = grid_.frame;
    const int x = frame.columnOf(from), y = frame.rowOf(from);
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || !frame.holds(x + dx, y + dy)) continue;
        const std::uint32_t to = frame.index(x + dx, y + dy);
        const bool is_diagonal = dx != 0 && dy != 0;
        // A diagonal step needs both cells beside it, also on a way that may cross closed cells.
        if (!mayUse(to) || (is_diagonal && !(isOpen(frame.index(x + dx, y)) && isOpen(frame.index(x, y + dy)))))
          continue;
        if (!grid_.isStepOpen(from, to) && !rules_.closed_cost) continue;
        visit(to, costOf(from, to, is_diagonal));
      }
  }

 private:
  bool isOpen(std::uint32_t cell) const { return grid_.closure[cell] == Closure::Open; }

  double costOf(std::uint32_t from, std::uint32_t to, bool is_diagonal) const {
    const double length_m = grid_.frame.cell_m * (is_diagonal ? std::sqrt(2.0) : 1.0);
    const double factor =
        rules_.is_priced ? (static_cast<double>(grid_.factor[from]) + static_cast<double>(grid_.factor[to])) / 2 : 1.0;
    const int closed = (isOpen(to) ? 0 : 1) + (grid_.isStepOpen(from, to) ? 0 : 1);
    return length_m * factor + (closed > 0 ? closed * *rules_.closed_cost : 0.0);
  }

  const PassableGrid& grid_;
  const SearchRules& rules_;
};

/// Dijkstra's algorithm. Equal costs keep the way that was found first.
class Search {
 public:
  Search(const PassableGrid& grid, const SearchRules& rules)
      : steps_(grid, rules),
        ways_{std::vector<double>(grid.frame.size(), kInfinite), std::vector<std::uint32_t>(grid.frame.size())},
        visited_(grid.frame.size(), Visited::No),
        place_in_queue_(grid.frame.size(), 0),
        queue_(ways_.cost.data(), place_in_queue_.data()) {
    std::iota(ways_.before.begin(), ways_.before.end(), 0U);
  }

  CheapestWays from(std::uint32_t start, const std::optional<std::uint32_t>& goal) {
    if (!steps_.mayUse(start)) return std::move(ways_);
    ways_.cost[start] = 0;
    visited_[start] = Visited::Waiting;
    queue_.push(start);
    while (!queue_.empty()) {
      const std::uint32_t cell = queue_.top();
      queue_.pop();
      if (cell == goal) break;
      const double cost = ways_.cost[cell];
      steps_.forEachFrom(cell, [&](std::uint32_t to, double more) { reach(to, cell, cost + more); });
      visited_[cell] = Visited::Done;
    }
    return std::move(ways_);
  }

 private:
  static constexpr double kInfinite = std::numeric_limits<double>::infinity();
  static constexpr std::size_t kChildren = 4;

  void reach(std::uint32_t cell, std::uint32_t before, double cost) {
    if (visited_[cell] == Visited::Done || !(cost < ways_.cost[cell])) return;
    ways_.cost[cell] = cost;
    ways_.before[cell] = before;
    const bool is_new = std::exchange(visited_[cell], Visited::Waiting) == Visited::No;
    is_new ? queue_.push(cell) : queue_.update(cell);
  }

  CellSteps steps_;
  CheapestWays ways_;
  std::vector<Visited> visited_;
  std::vector<std::uint32_t> place_in_queue_;
  boost::d_ary_heap_indirect<std::uint32_t, kChildren, std::uint32_t*, double*, std::less<double>> queue_;
};

}  // namespace

CheapestWays cheapestWays(const PassableGrid& grid, std::uint32_t start, const SearchRules& rules) {
  return Search(grid, rules).from(start, rules.goal);
}

std::vector<std::uint32_t> wayTo(const CheapestWays& ways, std::uint32_t goal) {
  if (!std::isfinite(ways.cost[goal])) return {};
  std::vector<std::uint32_t> way{goal};
  while (ways.before[way.back()] != way.back()) way.push_back(ways.before[way.back()]);
  std::reverse(way.begin(), way.end());
  return way;
}

}  // namespace cluxel::tasks
