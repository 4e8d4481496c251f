// SPDX-License-Identifier: Apache-2.0
// Selects the cluxels of a tile and its halo, and numbers them.
#include "perception/crf/halo_graph.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace cluxel::perception {

namespace {

constexpr std::uint32_t kOutside = std::numeric_limits<std::uint32_t>::max();
using NodeNumbers = std::array<std::vector<std::uint32_t>, 9>;

bool inHalo(const Eigen::Vector3f& p_local, double halo_m) {
  const auto low = static_cast<float>(-halo_m), high = static_cast<float>(kTileSize_m + halo_m);
  return p_local.x() >= low && p_local.x() < high && p_local.y() >= low && p_local.y() < high;
}

NodeNumbers numberNodes(const Ring<FeatureTile>& ring, double halo_m, HaloGraph& graph) {
  NodeNumbers number;
  for (std::uint32_t r = 0; r < ring.size(); ++r) {
    if (r == kRingCentre) graph.own_begin = static_cast<std::uint32_t>(graph.nodes.size());
    if (!ring[r]) continue;
    number[r].assign(ring[r]->size(), kOutside);
    for (std::uint32_t i = 0; i < ring[r]->size(); ++i) {
      if (r != kRingCentre && !inHalo(ring[r]->center[i] + ringShift(static_cast<int>(r)), halo_m)) continue;
      number[r][i] = static_cast<std::uint32_t>(graph.nodes.size());
      graph.nodes.push_back({r, i});
    }
    if (r == kRingCentre) graph.own_end = static_cast<std::uint32_t>(graph.nodes.size());
  }
  return number;
}

constexpr std::uint8_t kNoPlace = 9;

/// The ring position, relative to the centre, of position `second` in the ring of ring tile `first`; kNoPlace outside
/// the centre's ring.
struct Composed {
  std::array<std::array<std::uint8_t, 9>, 9> place;
  constexpr Composed() : place() {
    for (std::uint32_t first = 0; first < 9; ++first)
      for (std::uint32_t second = 0; second < 9; ++second) {
        const int x = static_cast<int>(first % 3 + second % 3) - 1, y = static_cast<int>(first / 3 + second / 3) - 1;
        place[first][second] = x < 0 || x > 2 || y < 0 || y > 2 ? kNoPlace : static_cast<std::uint8_t>(3 * y + x);
      }
  }
};
constexpr Composed kComposed;

std::uint32_t degreeOf(const FeatureTile& tile, std::uint32_t index) {
  return tile.edge_offset[index + 1] - tile.edge_offset[index];
}

}  // namespace

HaloGraph haloGraph(const Ring<FeatureTile>& ring, double halo_m) {
  HaloGraph graph;
  const NodeNumbers number = numberNodes(ring, halo_m, graph);
  std::size_t edges = 0;
  for (const auto& [r, index] : graph.nodes) edges += degreeOf(*ring[r], index);
  graph.edges.reserve(edges / 2);
  for (std::uint32_t i = 0; i < graph.nodes.size(); ++i) {
    const auto [r, index] = graph.nodes[i];
    const FeatureTile& tile = *ring[r];
    const std::size_t first = graph.edges.size();
    std::uint32_t row = tile.edge_row_offset[index];
    for (std::uint32_t e = tile.edge_offset[index]; e < tile.edge_offset[index + 1]; ++e) {
      const RingIndex target = tile.edge_target[e];
      if (!FeatureTile::hasRow(index, target)) continue;  // added at its other end, which has the smaller number
      const std::uint32_t here = row++;
      const std::size_t at = kComposed.place[r][target.ring];
      if (at == kNoPlace || target.index >= number[at].size()) continue;
      const std::uint32_t j = number[at][target.index];
      if (j == kOutside || j <= i) continue;
      graph.edges.push_back({{i, j}, r, here, degreeOf(tile, index) + degreeOf(*ring[at], target.index)});
    }
    // Targets and nodes are both sorted by ring position and number, so the nodes are found by advancing.
    const auto begin = graph.edges.begin() + static_cast<std::ptrdiff_t>(first);
    const auto by_ends = [](const HaloEdge& a, const HaloEdge& b) { return a.ends < b.ends; };
    if (!std::is_sorted(begin, graph.edges.end(), by_ends)) std::sort(begin, graph.edges.end(), by_ends);
  }
  return graph;
}

std::vector<const float*> nodeFeatures(const Ring<FeatureTile>& ring, const HaloGraph& graph, std::size_t columns) {
  std::vector<const float*> rows;
  rows.reserve(graph.nodes.size());
  for (const auto& [r, index] : graph.nodes) rows.push_back(ring[r]->features.data() + index * columns);
  return rows;
}

CrfGraph crfGraph(const Ring<FeatureTile>& ring, const HaloGraph& structure, const std::vector<LabelValues>& scores,
                  const PairModel& pairs) {
  CrfGraph graph;
  graph.unary.reserve(scores.size());
  for (const LabelValues& score : scores) {
    LabelCosts costs = softmax(score);
    for (float& cost : costs) cost = -pairs.unary_scale * std::log(std::max(cost, 1e-6F));
    graph.unary.push_back(costs);
  }
  if (pairs.pair_scale == 0) return graph;
  const PairCostTable table(pairs);
  graph.edges.reserve(structure.edges.size());
  std::vector<PairCostTable::Edge> edges;
  edges.reserve(structure.edges.size());
  for (const HaloEdge& edge : structure.edges) {
    graph.edges.push_back(edge.ends);
    edges.push_back({ring[edge.ring]->edge_features.data() + edge.row * table.columns(), edge.degrees});
  }
  graph.pair_costs = table.costsOf(edges);
  return graph;
}

}  // namespace cluxel::perception
