// SPDX-License-Identifier: Apache-2.0
// Oracles for CRF inference.
#include "perception/crf_oracle_fixture.hpp"

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <limits>

namespace cluxel::oracle {

using namespace scan;
using namespace perception;

namespace {

constexpr std::size_t kLabels = kPrimitiveLabelCount;

bool countUp(std::vector<std::uint8_t>& labels) {
  for (std::uint8_t& label : labels) {
    if (++label < kLabels) return true;
    label = 0;
  }
  return false;
}

float uniform(std::mt19937& random, float low, float high) {
  return low + (high - low) * static_cast<float>(random() % 100001U) / 100000.0F;
}

LabelCosts randomCosts(std::mt19937& random) {
  LabelCosts costs;
  for (float& cost : costs) cost = uniform(random, 0.0F, 3.0F);
  return costs;
}

PairCosts randomPairCosts(std::mt19937& random, float strength, bool potts) {
  PairCosts costs;
  costs.fill(uniform(random, 0.0F, strength));
  if (!potts)
    for (float& cost : costs) cost = uniform(random, 0.0F, strength);
  return costs;
}

using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
using FlowGraph = boost::adjacency_list<
    boost::vecS, boost::vecS, boost::directedS,
    boost::property<
        boost::vertex_index_t, long,
        boost::property<boost::vertex_color_t, boost::default_color_type,
                        boost::property<boost::vertex_distance_t, long,
                                        boost::property<boost::vertex_predecessor_t, Traits::edge_descriptor>>>>,
    boost::property<boost::edge_capacity_t, double,
                    boost::property<boost::edge_residual_capacity_t, double,
                                    boost::property<boost::edge_reverse_t, Traits::edge_descriptor>>>>;

void connect(FlowGraph& flow, std::size_t from, std::size_t to, double there, double back) {
  const auto forth = boost::add_edge(from, to, flow).first;
  const auto reverse = boost::add_edge(to, from, flow).first;
  boost::put(boost::edge_capacity, flow, forth, there);
  boost::put(boost::edge_capacity, flow, reverse, back);
  boost::put(boost::edge_reverse, flow, forth, reverse);
  boost::put(boost::edge_reverse, flow, reverse, forth);
}

double pairCost(const CrfGraph& graph, std::size_t edge, std::size_t a, std::size_t b) {
  return a == b ? 0.0 : static_cast<double>(graph.pair_costs[edge][labelPair(a, b)]);
}

/// The best labelling in which each node keeps its label (source side) or takes alpha (sink side).
std::vector<std::uint8_t> expansionMove(const CrfGraph& graph, const std::vector<std::uint8_t>& labels,
                                        std::uint8_t alpha) {
  const std::size_t n = graph.size(), source = n, sink = n + 1;
  std::vector<double> keep(n), take(n);
  for (std::size_t i = 0; i < n; ++i) {
    keep[i] = static_cast<double>(graph.unary[i][labels[i]]);
    take[i] = static_cast<double>(graph.unary[i][alpha]);
  }
  FlowGraph flow(n + 2);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const auto [i, j] = graph.edges[e];
    const double keep_take = pairCost(graph, e, labels[i], alpha), take_keep = pairCost(graph, e, alpha, labels[j]);
    const double keep_keep = std::min(pairCost(graph, e, labels[i], labels[j]), keep_take + take_keep);
    // theta(x_i, x_j) with theta(take, take) = 0, in the normal form of Kolmogorov and Zabih 2004.
    keep[i] += keep_keep - take_keep;
    keep[j] += take_keep;
    connect(flow, i, j, keep_take + take_keep - keep_keep, 0.0);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double least = std::min(keep[i], take[i]);
    connect(flow, source, i, take[i] - least, 0.0);
    connect(flow, i, sink, keep[i] - least, 0.0);
  }
  boost::boykov_kolmogorov_max_flow(flow, source, sink);
  std::vector<std::uint8_t> moved = labels;
  const auto color = boost::get(boost::vertex_color, flow);
  for (std::size_t i = 0; i < n; ++i)
    if (color[i] != color[source]) moved[i] = alpha;
  return moved;
}

}  // namespace

double energyOf(const CrfGraph& graph, std::span<const std::uint8_t> labels) {
  double energy = 0;
  for (std::size_t i = 0; i < graph.size(); ++i) energy += static_cast<double>(graph.unary[i][labels[i]]);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const std::uint8_t a = labels[graph.edges[e].from], b = labels[graph.edges[e].to];
    if (a != b) energy += static_cast<double>(graph.pair_costs[e][labelPair(a, b)]);
  }
  return energy;
}

Labelling enumerate(const CrfGraph& graph) {
  Labelling best{{}, std::numeric_limits<double>::infinity()};
  std::vector<std::uint8_t> labels(graph.size(), 0);
  do {
    const double energy = energyOf(graph, labels);
    if (energy < best.energy) best = {labels, energy};
  } while (countUp(labels));
  return best;
}

std::vector<std::array<double, kPrimitiveLabelCount>> enumerateMinMarginals(const CrfGraph& graph) {
  std::array<double, kLabels> none;
  none.fill(std::numeric_limits<double>::infinity());
  std::vector<std::array<double, kLabels>> least(graph.size(), none);
  std::vector<std::uint8_t> labels(graph.size(), 0);
  do {
    const double energy = energyOf(graph, labels);
    for (std::size_t i = 0; i < graph.size(); ++i) least[i][labels[i]] = std::min(least[i][labels[i]], energy);
  } while (countUp(labels));
  for (auto& costs : least) {
    const double best = *std::min_element(costs.begin(), costs.end());
    for (double& cost : costs) cost -= best;
  }
  return least;
}

Labelling expandAlpha(const CrfGraph& graph) {
  Labelling best;
  for (const LabelCosts& costs : graph.unary)
    best.labels.push_back(static_cast<std::uint8_t>(std::min_element(costs.begin(), costs.end()) - costs.begin()));
  best.energy = energyOf(graph, best.labels);
  for (bool lowered = true; lowered;) {
    lowered = false;
    for (std::uint8_t alpha = 0; alpha < kLabels; ++alpha) {
      std::vector<std::uint8_t> moved = expansionMove(graph, best.labels, alpha);
      const double energy = energyOf(graph, moved);
      if (energy >= best.energy - 1e-9) continue;
      best = {std::move(moved), energy};
      lowered = true;
    }
  }
  return best;
}

CrfGraph randomGraph(std::mt19937& random, const RandomGraph& kind) {
  CrfGraph graph;
  for (std::uint32_t i = 0; i < kind.nodes; ++i) graph.unary.push_back(randomCosts(random));
  for (std::uint32_t i = 0; i < kind.nodes; ++i)
    for (std::uint32_t j = i + 1; j < kind.nodes; ++j) {
      if (static_cast<double>(uniform(random, 0.0F, 1.0F)) >= kind.edge_probability) continue;
      graph.edges.push_back({i, j});
      graph.pair_costs.push_back(randomPairCosts(random, kind.pair_strength, kind.potts));
    }
  return graph;
}

CrfGraph randomChain(std::mt19937& random, std::size_t nodes) {
  CrfGraph graph;
  for (std::uint32_t i = 0; i < nodes; ++i) graph.unary.push_back(randomCosts(random));
  for (std::uint32_t i = 0; i + 1 < nodes; ++i) {
    graph.edges.push_back({i, i + 1});
    graph.pair_costs.push_back(randomPairCosts(random, 2.0F, false));
  }
  return graph;
}

CrfGraph noisyGrid(std::mt19937& random, std::uint32_t side) {
  CrfGraph graph;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    LabelCosts costs = randomCosts(random);
    costs[(i % side / 6 + i / side / 6) % kLabels] -= 1.0F;
    graph.unary.push_back(costs);
    for (const std::uint32_t j : {i + 1, i + side, i + side + 1}) {
      if (j >= side * side || (j != i + side && i % side == side - 1)) continue;
      graph.edges.push_back({i, j});
      graph.pair_costs.push_back(randomPairCosts(random, 0.8F, true));
    }
  }
  return graph;
}

}  // namespace cluxel::oracle
