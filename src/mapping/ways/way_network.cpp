// SPDX-License-Identifier: Apache-2.0
// Cells with three or more neighbours are nodes, and so are ends; lines are followed from node to node.
#include "mapping/ways/way_network.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "base/disjoint_sets.hpp"

namespace cluxel::mapping {

namespace {

class NetworkMaker {
 public:
  NetworkMaker(const TileCells& cells, const std::vector<std::uint8_t>& skeleton,
               const std::vector<std::uint16_t>& edge_distance2)
      : cells_(cells), skeleton_(skeleton), edge_distance2_(edge_distance2) {}

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
  std::vector<std::uint32_t> neighbours(std::uint32_t cell) const {
    std::vector<std::uint32_t> found;
    for (const auto& [dx, dy] : kAroundCell)
      if (const std::uint32_t near = cells_.step(cell, dx, dy); near != kNoCell && skeleton_[near] != 0)
        found.push_back(near);
    return found;
  }
  double clearance_m(std::uint32_t node) const {
    return kWayCell_m * std::sqrt(static_cast<double>(edge_distance2_[network_.nodes[node]]));
  }
  double length_m(const SkeletonLine& line) const {
    std::vector<std::uint32_t> all{network_.nodes[line.from]};
    all.insert(all.end(), line.cells.begin(), line.cells.end());
    all.push_back(network_.nodes[line.to]);
    double length = 0;
    for (std::size_t i = 1; i < all.size(); ++i)
      length += (cells_.centreOf(all[i]) - cells_.centreOf(all[i - 1])).norm();
    return length;
  }

  /// A node for each end and for each group of cells with three or more neighbours: its cell farthest from the edge.
  void findNodes() {
    std::vector<std::uint8_t> branches(skeleton_.size(), 0);
    for (std::uint32_t cell = 0; cell < cells_.size(); ++cell) {
      if (skeleton_[cell] == 0) continue;
      const std::size_t degree = neighbours(cell).size();
      if (degree >= 3) branches[cell] = 1;
      if (degree == 1) addNode({cell});
    }
    for (std::uint32_t cell = 0; cell < cells_.size(); ++cell) {
      if (branches[cell] == 0) continue;
      std::vector<std::uint32_t> group{cell};
      branches[cell] = 0;
      for (std::size_t at = 0; at < group.size(); ++at)
        for (const std::uint32_t near : neighbours(group[at]))
          if (branches[near] != 0) {
            branches[near] = 0;
            group.push_back(near);
          }
      addNode(group);
    }
  }
  void addNode(std::vector<std::uint32_t> group) {
    const auto number = static_cast<std::uint32_t>(network_.nodes.size());
    for (const std::uint32_t cell : group) node_of_[cell] = number;
    network_.nodes.push_back(*std::min_element(group.begin(), group.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple(-int{edge_distance2_[a]}, a) < std::tuple(-int{edge_distance2_[b]}, b);
    }));
  }

  void followLines() {
    for (const auto& [start, node] : node_of_)
      for (const std::uint32_t next : neighbours(start)) {
        if (const auto other = node_of_.find(next); other != node_of_.end()) {
          if (node < other->second) network_.lines.push_back({node, other->second, {}});
        } else if (!passed_[next]) {
          follow(start, node, next);
        }
      }
    for (std::uint32_t cell = 0; cell < cells_.size(); ++cell)
      if (skeleton_[cell] != 0 && !node_of_.contains(cell) && !passed_[cell] && neighbours(cell).size() == 2) {
        addNode({cell});
        follow(cell, node_of_[cell], neighbours(cell).front());
      }
  }
  void follow(std::uint32_t before, std::uint32_t node, std::uint32_t cell) {
    SkeletonLine line{node, node, {}};
    for (;;) {
      passed_[cell] = true;
      line.cells.push_back(cell);
      const auto ways = neighbours(cell);
      const std::uint32_t next = ways[0] == before ? ways[1] : ways[0];
      if (const auto end = node_of_.find(next); end != node_of_.end()) {
        line.to = end->second;
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
      return std::tuple(-int{edge_distance2_[network_.nodes[node]]}, network_.nodes[node]);
    };
    for (const SkeletonLine& line : network_.lines) {
      if (network_.line_ends[line.from] < 3 || network_.line_ends[line.to] < 3 || line.from == line.to) continue;
      if (length_m(line) > std::max(clearance_m(line.from), clearance_m(line.to))) continue;
      groups.join(line.from, line.to);
    }
    std::vector<std::uint32_t> farthest(network_.nodes.size());  // of each group, by its representative
    std::iota(farthest.begin(), farthest.end(), 0);
    for (std::uint32_t node = 0; node < network_.nodes.size(); ++node)
      if (std::uint32_t& best = farthest[groups.find(node)]; rank(node) < rank(best)) best = node;
    for (SkeletonLine& line : network_.lines) {
      const bool was_loop = line.from == line.to;
      const double length = length_m(line), clearance = std::max(clearance_m(line.from), clearance_m(line.to));
      line.from = farthest[groups.find(line.from)], line.to = farthest[groups.find(line.to)];
      if (line.from == line.to && !was_loop && length <= clearance) line.cells.clear();
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
      const double length = length_m(line);
      if (length > widths * clearance_m(junction) + beyond_m) continue;
      spurs.push_back({length, network_.nodes[ends_first ? line.from : line.to], junction, i});
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

  const TileCells& cells_;
  const std::vector<std::uint8_t>& skeleton_;
  const std::vector<std::uint16_t>& edge_distance2_;
  std::map<std::uint32_t, std::uint32_t> node_of_;
  std::vector<bool> passed_ = std::vector<bool>(skeleton_.size(), false);
  SkeletonNetwork network_;
};

}  // namespace

SkeletonNetwork networkOf(const TileCells& cells, const std::vector<std::uint8_t>& skeleton,
                          const std::vector<std::uint16_t>& edge_distance2) {
  return NetworkMaker(cells, skeleton, edge_distance2).make();
}

}  // namespace cluxel::mapping
