// SPDX-License-Identifier: Apache-2.0
// The usable cells as a graph of Boost, and Dijkstra's algorithm on it.
#include "tasks/ways/way_search.hpp"

#include <algorithm>
#include <array>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <cmath>
#include <limits>

namespace cluxel::tasks {

namespace {

struct Weight {
  double cost = 0;
};
using WayGraph = boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, Weight, boost::no_property,
                                                    std::uint32_t, std::uint32_t>;

constexpr std::uint32_t kNoVertex = 0xffffffffU;

/// Vertices are the cells that may be used.
class GraphOfCells {
 public:
  GraphOfCells(const PassableGrid& grid, const SearchRules& rules) : grid_(grid), rules_(rules) {
    vertex_of_.assign(grid.frame.size(), kNoVertex);
    for (std::uint32_t cell = 0; cell < grid.frame.size(); ++cell)
      if (mayUse(cell)) {
        vertex_of_[cell] = static_cast<std::uint32_t>(cell_of_.size());
        cell_of_.push_back(cell);
      }
  }

  WayGraph graph() const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    std::vector<Weight> weights;
    for (std::uint32_t vertex = 0; vertex < cell_of_.size(); ++vertex) addEdges(vertex, edges, weights);
    return {boost::edges_are_sorted, edges.begin(), edges.end(), weights.begin(),
            static_cast<std::uint32_t>(cell_of_.size())};
  }
  std::uint32_t vertexOf(std::uint32_t cell) const { return vertex_of_[cell]; }
  const std::vector<std::uint32_t>& cells() const { return cell_of_; }

 private:
  bool isOpen(std::uint32_t cell) const { return grid_.closure[cell] == Closure::Open; }
  bool mayUse(std::uint32_t cell) const { return isOpen(cell) || rules_.closed_cost; }

  template <typename Edges>
  void addEdges(std::uint32_t vertex, Edges& edges, std::vector<Weight>& weights) const {
    const GridFrame& frame = grid_.frame;
    const std::uint32_t from = cell_of_[vertex];
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
        edges.emplace_back(vertex, vertex_of_[to]);
        weights.push_back({costOf(from, to, is_diagonal)});
      }
  }

  double costOf(std::uint32_t from, std::uint32_t to, bool is_diagonal) const {
    const double length_m = grid_.frame.cell_m * (is_diagonal ? std::sqrt(2.0) : 1.0);
    const double factor =
        rules_.is_priced ? (static_cast<double>(grid_.factor[from]) + static_cast<double>(grid_.factor[to])) / 2 : 1.0;
    const int closed = (isOpen(to) ? 0 : 1) + (grid_.isStepOpen(from, to) ? 0 : 1);
    return length_m * factor + (closed > 0 ? closed * *rules_.closed_cost : 0.0);
  }

  const PassableGrid& grid_;
  const SearchRules& rules_;
  std::vector<std::uint32_t> vertex_of_, cell_of_;
};

/// Ends the search when the goal's cost is known.
struct GoalReached {};
struct StopAtGoal : boost::default_dijkstra_visitor {
  explicit StopAtGoal(std::uint32_t goal_cell) : goal(goal_cell) {}
  void examine_vertex(std::uint32_t vertex, const WayGraph&) const {
    if (vertex == goal) throw GoalReached();
  }
  std::uint32_t goal;
};

}  // namespace

CheapestWays cheapestWays(const PassableGrid& grid, std::uint32_t start, const SearchRules& rules) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const GraphOfCells cells(grid, rules);
  CheapestWays ways{std::vector<double>(grid.frame.size(), infinite), std::vector<std::uint32_t>(grid.frame.size())};
  for (std::uint32_t cell = 0; cell < ways.before.size(); ++cell) ways.before[cell] = cell;
  const std::uint32_t first = cells.vertexOf(start);
  if (first == kNoVertex) return ways;
  const WayGraph graph = cells.graph();
  const std::size_t count = cells.cells().size();
  std::vector<double> cost(count, infinite);
  std::vector<std::uint32_t> before(count);
  const auto index = boost::get(boost::vertex_index, graph);
  try {
    boost::dijkstra_shortest_paths(graph, first,
                                   boost::weight_map(boost::get(&Weight::cost, graph))
                                       .distance_map(boost::make_iterator_property_map(cost.begin(), index))
                                       .predecessor_map(boost::make_iterator_property_map(before.begin(), index))
                                       .visitor(StopAtGoal(rules.goal ? cells.vertexOf(*rules.goal) : kNoVertex)));
  } catch (const GoalReached&) {  // the search has what it needs
  }
  for (std::uint32_t vertex = 0; vertex < count; ++vertex) {
    // Boost's infinity is the largest number.
    if (cost[vertex] >= std::numeric_limits<double>::max()) continue;
    ways.cost[cells.cells()[vertex]] = cost[vertex];
    ways.before[cells.cells()[vertex]] = cells.cells()[before[vertex]];
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
