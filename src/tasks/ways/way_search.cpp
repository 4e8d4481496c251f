// SPDX-License-Identifier: Apache-2.0
// The usable cells as an implicit graph of Boost, and Dijkstra's algorithm on it.
#include "tasks/ways/way_search.hpp"

#include <algorithm>
#include <array>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <boost/graph/graph_traits.hpp>
#include <boost/graph/two_bit_color_map.hpp>
#include <boost/iterator/iterator_facade.hpp>
#include <boost/property_map/property_map.hpp>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

namespace cluxel::tasks {

namespace {

using Cell = std::uint32_t;

struct CellStep {
  Cell from = 0, to = 0;
  double cost = 0;
  bool operator==(const CellStep&) const = default;
};

/// The steps from a cell, of which there are eight at most.
struct CellSteps {
  std::array<CellStep, 8> step;
  std::ptrdiff_t count = 0;
};

class StepIterator
    : public boost::iterator_facade<StepIterator, const CellStep, boost::random_access_traversal_tag, const CellStep&> {
 public:
  StepIterator() = default;
  StepIterator(const CellSteps& steps, std::ptrdiff_t at) : steps_(steps), at_(at) {}

 private:
  friend class boost::iterator_core_access;
  const CellStep& dereference() const { return steps_.step[static_cast<std::size_t>(at_)]; }
  bool equal(const StepIterator& other) const { return at_ == other.at_; }
  void increment() { ++at_; }
  void decrement() { --at_; }
  void advance(std::ptrdiff_t count) { at_ += count; }
  std::ptrdiff_t distance_to(const StepIterator& other) const { return other.at_ - at_; }

  CellSteps steps_;
  std::ptrdiff_t at_ = 0;
};

/// The cells of a grid as vertices. Edges are told when they are asked for: to hold them takes 200 bytes a cell.
class CellGraph {
 public:
  using vertex_descriptor = Cell;
  using edge_descriptor = CellStep;
  using out_edge_iterator = StepIterator;
  using vertices_size_type = std::size_t;
  using degree_size_type = std::size_t;
  using directed_category = boost::directed_tag;
  using edge_parallel_category = boost::disallow_parallel_edge_tag;
  struct traversal_category : boost::incidence_graph_tag {};

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
        steps.step[static_cast<std::size_t>(steps.count++)] = {from, to, costOf(from, to, is_diagonal)};
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

// What Boost asks of a graph.
[[maybe_unused]] std::size_t num_vertices(const CellGraph& graph) {
  return graph.size();
}
[[maybe_unused]] std::pair<StepIterator, StepIterator> out_edges(Cell cell, const CellGraph& graph) {
  const CellSteps steps = graph.stepsFrom(cell);
  return {StepIterator(steps, 0), StepIterator(steps, steps.count)};
}
[[maybe_unused]] std::size_t out_degree(Cell cell, const CellGraph& graph) {
  return static_cast<std::size_t>(graph.stepsFrom(cell).count);
}
[[maybe_unused]] Cell source(const CellStep& step, const CellGraph&) {
  return step.from;
}
[[maybe_unused]] Cell target(const CellStep& step, const CellGraph&) {
  return step.to;
}

/// The cost of an edge, which it holds itself.
struct CostOfStep {
  using key_type = CellStep;
  using value_type = double;
  using reference = double;
  using category = boost::readable_property_map_tag;
};
[[maybe_unused]] double get(const CostOfStep&, const CellStep& step) {
  return step.cost;
}

/// Ends the search when the goal's cost is known.
struct GoalReached {};
struct StopAtGoal : boost::default_dijkstra_visitor {
  explicit StopAtGoal(std::optional<Cell> goal_cell) : goal(goal_cell) {}
  void examine_vertex(Cell cell, const CellGraph&) const {
    if (cell == goal) throw GoalReached();
  }
  std::optional<Cell> goal;
};

}  // namespace

CheapestWays cheapestWays(const PassableGrid& grid, std::uint32_t start, const SearchRules& rules) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const CellGraph graph(grid, rules);
  CheapestWays ways{std::vector<double>(graph.size(), infinite), std::vector<std::uint32_t>(graph.size())};
  std::iota(ways.before.begin(), ways.before.end(), 0U);
  if (!graph.mayUse(start)) return ways;
  ways.cost[start] = 0;
  const boost::typed_identity_property_map<Cell> index;
  try {
    boost::dijkstra_shortest_paths_no_init(graph, start, boost::make_iterator_property_map(ways.before.begin(), index),
                                           boost::make_iterator_property_map(ways.cost.begin(), index), CostOfStep{},
                                           index, std::less<double>(), std::plus<double>(), 0.0, StopAtGoal(rules.goal),
                                           boost::make_two_bit_color_map(graph.size(), index));
  } catch (const GoalReached&) {  // the cost of the goal is known
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
