// SPDX-License-Identifier: Apache-2.0
// Cells with three or more neighbours are nodes, and so are ends; lines are followed from node to node.
#include "mapping/ways/way_network.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "base/disjoint_sets.hpp"

namespace cluxel::mapping {

namespace {

class NetworkMaker {
 public:
  explicit NetworkMaker(const LineGraph& graph) : graph_(graph) {}

  SkeletonNetwork make() {
    findNodes();
    followLines();
    joinNodes();
    dissolveNodes();
    while (dropSpurs()) dissolveNodes();
    countEnds();
    return std::move(network_);
  }

 private:
  double clearance_m(std::uint32_t node) const {
    return kWayCell_m * std::sqrt(static_cast<double>(graph_.edge_distance2[network_.nodes[node]]));
  }
  void measure(SkeletonLine& line) const {
    double length = 0;
    std::uint32_t last = network_.nodes[line.from];
    const auto go = [&](std::uint32_t cell) {
      const CellPlace &a = graph_.place[last], &b = graph_.place[cell];
      const auto dx = static_cast<double>(b.x - a.x), dy = static_cast<double>(b.y - a.y);
      length += std::sqrt(dx * dx + dy * dy);
      last = cell;
    };
    for (const std::uint32_t cell : line.cells) go(cell);
    go(network_.nodes[line.to]);
    line.length_m = kWayCell_m * length;
  }

  /// A node for each end and for each group of cells with three or more neighbours: its cell farthest from the edge.
  void findNodes() {
    std::vector<std::uint8_t> branches(graph_.size(), 0);
    for (std::uint32_t cell = 0; cell < graph_.size(); ++cell) {
      const std::size_t degree = graph_.neighboursOf(cell).size();
      if (degree >= 3) branches[cell] = 1;
      if (degree == 1) addNode({cell});
    }
    for (std::uint32_t cell = 0; cell < graph_.size(); ++cell) {
      if (branches[cell] == 0) continue;
      std::vector<std::uint32_t> group{cell};
      branches[cell] = 0;
      for (std::size_t at = 0; at < group.size(); ++at)
        for (const std::uint32_t near : graph_.neighboursOf(group[at]))
          if (branches[near] != 0) {
            branches[near] = 0;
            group.push_back(near);
          }
      addNode(group);
    }
  }
  void addNode(const std::vector<std::uint32_t>& group) {
    const auto number = static_cast<std::uint32_t>(network_.nodes.size());
    for (const std::uint32_t cell : group) node_of_[cell] = number;
    network_.nodes.push_back(*std::min_element(group.begin(), group.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple(-int{graph_.edge_distance2[a]}, a) < std::tuple(-int{graph_.edge_distance2[b]}, b);
    }));
  }

  void followLines() {
    for (std::uint32_t start = 0; start < graph_.size(); ++start) {
      const std::uint32_t node = node_of_[start];
      if (node == kNoCell) continue;
      for (const std::uint32_t next : graph_.neighboursOf(start))
        if (const std::uint32_t other = node_of_[next]; other != kNoCell) {
          if (node < other) network_.lines.push_back({node, other, {}});
        } else if (!passed_[next]) {
          follow(start, node, next);
        }
    }
    for (std::uint32_t cell = 0; cell < graph_.size(); ++cell)
      if (node_of_[cell] == kNoCell && !passed_[cell] && graph_.neighboursOf(cell).size() == 2) {
        addNode({cell});
        follow(cell, node_of_[cell], graph_.neighboursOf(cell).front());
      }
    for (SkeletonLine& line : network_.lines) measure(line);
  }
  void follow(std::uint32_t before, std::uint32_t node, std::uint32_t cell) {
    SkeletonLine line{node, node, {}};
    for (;;) {
      passed_[cell] = true;
      line.cells.push_back(cell);
      const auto ways = graph_.neighboursOf(cell);
      const std::uint32_t next = ways[0] == before ? ways[1] : ways[0];
      if (node_of_[next] != kNoCell) {
        line.to = node_of_[next];
        break;
      }
      before = cell;
      cell = next;
    }
    constexpr std::size_t least_loop = 4;
    if (line.from != line.to || line.cells.size() >= least_loop) network_.lines.push_back(std::move(line));
  }

  void countEnds() {
    network_.line_ends.assign(network_.nodes.size(), 0);
    for (const SkeletonLine& line : network_.lines) {
      ++network_.line_ends[line.from];
      ++network_.line_ends[line.to];
    }
  }

  /// Merges junctions that are nearer to each other than the way is wide there into the one farthest from the edge.
  void joinNodes() {
    countEnds();
    DisjointSets groups(network_.nodes.size());
    const auto rank = [&](std::uint32_t node) {
      return std::tuple(-int{graph_.edge_distance2[network_.nodes[node]]}, network_.nodes[node]);
    };
    for (const SkeletonLine& line : network_.lines) {
      if (network_.line_ends[line.from] < 3 || network_.line_ends[line.to] < 3 || line.from == line.to) continue;
      if (line.length_m > std::max(clearance_m(line.from), clearance_m(line.to))) continue;
      groups.join(line.from, line.to);
    }
    std::vector<std::uint32_t> farthest(network_.nodes.size());  // of each group, by its representative
    std::iota(farthest.begin(), farthest.end(), 0);
    for (std::uint32_t node = 0; node < network_.nodes.size(); ++node)
      if (std::uint32_t& best = farthest[groups.find(node)]; rank(node) < rank(best)) best = node;
    for (SkeletonLine& line : network_.lines) {
      const bool was_loop = line.from == line.to;
      const double clearance = std::max(clearance_m(line.from), clearance_m(line.to));
      line.from = farthest[groups.find(line.from)], line.to = farthest[groups.find(line.to)];
      if (line.from == line.to && !was_loop && line.length_m <= clearance) line.cells.clear();
      measure(line);
    }
    std::erase_if(network_.lines, [](const SkeletonLine& line) { return line.from == line.to && line.cells.empty(); });
  }

  /// Removes dead ends that lie within the width of their junction, shortest first. At least two lines of a junction
  /// stay. Returns false when there was none.
  bool dropSpurs() {
    constexpr double widths = 1.5, beyond_m = 1;
    struct Spur {
      double length_m;
      std::uint32_t end_cell, junction;
      std::size_t line;
    };
    std::vector<Spur> spurs;
    countEnds();
    for (std::size_t i = 0; i < network_.lines.size(); ++i) {
      const SkeletonLine& line = network_.lines[i];
      const bool ends_first = network_.line_ends[line.from] == 1, ends_last = network_.line_ends[line.to] == 1;
      const std::uint32_t junction = ends_first ? line.to : line.from;
      if (ends_first == ends_last || network_.line_ends[junction] < 3) continue;
      if (line.length_m > widths * clearance_m(junction) + beyond_m) continue;
      spurs.push_back({line.length_m, network_.nodes[ends_first ? line.from : line.to], junction, i});
    }
    std::sort(spurs.begin(), spurs.end(), [](const Spur& a, const Spur& b) {
      return std::tuple(a.length_m, a.end_cell) < std::tuple(b.length_m, b.end_cell);
    });
    std::vector<bool> dropped(network_.lines.size(), false);
    bool any = false;
    for (const Spur& spur : spurs) {
      if (network_.line_ends[spur.junction] < 3) continue;
      --network_.line_ends[spur.junction];
      dropped[spur.line] = true;
      any = true;
    }
    erase(dropped);
    return any;
  }

  /// Two lines that meet alone become one.
  void dissolveNodes() {
    std::vector<SkeletonLine>& lines = network_.lines;
    std::vector<std::vector<std::size_t>> at(network_.nodes.size());
    for (std::size_t i = 0; i < lines.size(); ++i)
      for (const std::uint32_t node : {lines[i].from, lines[i].to}) at[node].push_back(i);
    std::vector<bool> gone(lines.size(), false);
    for (std::uint32_t node = 0; node < network_.nodes.size(); ++node) {
      if (at[node].size() != 2 || at[node][0] == at[node][1]) continue;
      SkeletonLine &first = lines[at[node][0]], &second = lines[at[node][1]];
      if (first.from == node) reverse(first);
      if (second.to == node) reverse(second);
      first.cells.push_back(network_.nodes[node]);
      first.cells.insert(first.cells.end(), second.cells.begin(), second.cells.end());
      first.to = second.to;
      first.length_m += second.length_m;
      gone[at[node][1]] = true;
      std::replace(at[first.to].begin(), at[first.to].end(), at[node][1], at[node][0]);
      at[node].clear();
    }
    erase(gone);
  }
  void erase(const std::vector<bool>& gone) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < gone.size(); ++i)
      if (!gone[i]) std::swap(network_.lines[kept++], network_.lines[i]);
    network_.lines.resize(kept);
  }
  static void reverse(SkeletonLine& line) {
    std::swap(line.from, line.to);
    std::reverse(line.cells.begin(), line.cells.end());
  }

  const LineGraph& graph_;
  std::vector<std::uint32_t> node_of_ = std::vector<std::uint32_t>(graph_.size(), kNoCell);
  std::vector<bool> passed_ = std::vector<bool>(graph_.size(), false);
  SkeletonNetwork network_;
};

}  // namespace

SkeletonNetwork networkOf(const LineGraph& graph) {
  return NetworkMaker(graph).make();
}

}  // namespace cluxel::mapping
