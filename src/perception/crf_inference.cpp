// SPDX-License-Identifier: Apache-2.0
// TRW-S over nodes in the order of their numbers. Messages live on edges, one for each direction.
#include "cluxel/perception/crf_inference.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel {

namespace {

constexpr std::size_t kLabels = kPrimitiveLabelCount;

/// The edges at each node: those to later nodes are a range of the sorted edges, those to earlier ones are listed.
struct Incidence {
  std::vector<std::uint32_t> forward_begin;    // size + 1, into edges
  std::vector<std::uint32_t> backward_begin;   // size + 1, into backward
  std::vector<std::uint32_t> backward;         // edge numbers, ascending by `from`
};

Incidence incidenceOf(const CrfGraph& graph) {
  Incidence at;
  at.forward_begin.assign(graph.size() + 1, 0);
  at.backward_begin.assign(graph.size() + 1, 0);
  for (const CrfEdge& edge : graph.edges) {
    ++at.forward_begin[edge.from + 1];
    ++at.backward_begin[edge.to + 1];
  }
  for (std::size_t i = 0; i < graph.size(); ++i) {
    at.forward_begin[i + 1] += at.forward_begin[i];
    at.backward_begin[i + 1] += at.backward_begin[i];
  }
  at.backward.resize(graph.edges.size());
  std::vector<std::uint32_t> next(at.backward_begin.begin(), at.backward_begin.end() - 1);
  for (std::uint32_t e = 0; e < graph.edges.size(); ++e) at.backward[next[graph.edges[e].to]++] = e;
  return at;
}

void add(LabelCosts& sum, const LabelCosts& term) {
  for (std::size_t a = 0; a < kLabels; ++a) sum[a] += term[a];
}

float subtractMin(LabelCosts& costs) {
  const float least = *std::min_element(costs.begin(), costs.end());
  for (float& cost : costs) cost -= least;
  return least;
}

/// min over a of from[a] + V(a, b), for each b.
LabelCosts minSum(const LabelCosts& from, const PairCosts& pair) {
  LabelCosts best = from;
  std::size_t slot = 0;
  for (std::size_t a = 0; a < kLabels; ++a)
    for (std::size_t b = a + 1; b < kLabels; ++b, ++slot) {
      best[b] = std::min(best[b], from[a] + pair[slot]);
      best[a] = std::min(best[a], from[b] + pair[slot]);
    }
  return best;
}

class Trws {
 public:
  explicit Trws(const CrfGraph& graph)
      : x_graph(graph), x_at(incidenceOf(graph)), x_to_later(graph.edges.size()), x_to_earlier(graph.edges.size()) {}

  void passForward() {
    for (std::uint32_t i = 0; i < x_graph.size(); ++i) sendForward(i, belief(i));
  }

  /// Returns the lower bound that the messages prove.
  double passBackward() {
    double bound = 0;
    for (std::uint32_t i = static_cast<std::uint32_t>(x_graph.size()); i-- > 0;) {
      LabelCosts costs = belief(i);
      bound += static_cast<double>(subtractMin(costs));
      bound += sendBackward(i, costs);
    }
    return bound;
  }

  /// The last pass forward: each node takes the best label given those before it.
  std::vector<std::uint8_t> decode() {
    std::vector<std::uint8_t> labels(x_graph.size());
    for (std::uint32_t i = 0; i < x_graph.size(); ++i) {
      LabelCosts costs = x_graph.unary[i];
      for (std::uint32_t k = x_at.backward_begin[i]; k < x_at.backward_begin[i + 1]; ++k)
        addFixed(costs, x_at.backward[k], labels[x_graph.edges[x_at.backward[k]].from]);
      for (std::uint32_t e = x_at.forward_begin[i]; e < x_at.forward_begin[i + 1]; ++e) add(costs, x_to_earlier[e]);
      labels[i] = static_cast<std::uint8_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
    }
    return labels;
  }

  /// The min-marginals of a node, summed over the trees through it, as the messages stand.
  LabelCosts minMarginals(std::uint32_t i) const {
    LabelCosts costs = belief(i);
    subtractMin(costs);
    return costs;
  }

 private:
  LabelCosts belief(std::uint32_t i) const {
    LabelCosts costs = x_graph.unary[i];
    for (std::uint32_t k = x_at.backward_begin[i]; k < x_at.backward_begin[i + 1]; ++k)
      add(costs, x_to_later[x_at.backward[k]]);
    for (std::uint32_t e = x_at.forward_begin[i]; e < x_at.forward_begin[i + 1]; ++e) add(costs, x_to_earlier[e]);
    return costs;
  }

  /// One over the number of monotonic chains through a node.
  float treeShare(std::uint32_t i) const {
    const std::uint32_t later = x_at.forward_begin[i + 1] - x_at.forward_begin[i];
    const std::uint32_t earlier = x_at.backward_begin[i + 1] - x_at.backward_begin[i];
    return 1.0F / static_cast<float>(std::max({later, earlier, 1U}));
  }

  static LabelCosts without(const LabelCosts& belief, float share, const LabelCosts& message) {
    LabelCosts rest;
    for (std::size_t a = 0; a < kLabels; ++a) rest[a] = share * belief[a] - message[a];
    return rest;
  }

  void sendForward(std::uint32_t i, const LabelCosts& costs) {
    const float share = treeShare(i);
    for (std::uint32_t e = x_at.forward_begin[i]; e < x_at.forward_begin[i + 1]; ++e) {
      x_to_later[e] = minSum(without(costs, share, x_to_earlier[e]), x_graph.pair_costs[e]);
      subtractMin(x_to_later[e]);
    }
  }

  double sendBackward(std::uint32_t i, const LabelCosts& costs) {
    const float share = treeShare(i);
    double bound = 0;
    for (std::uint32_t k = x_at.backward_begin[i]; k < x_at.backward_begin[i + 1]; ++k) {
      const std::uint32_t e = x_at.backward[k];
      x_to_earlier[e] = minSum(without(costs, share, x_to_later[e]), x_graph.pair_costs[e]);
      bound += static_cast<double>(subtractMin(x_to_earlier[e]));
    }
    return bound;
  }

  void addFixed(LabelCosts& costs, std::uint32_t edge, std::uint8_t neighbour) const {
    for (std::size_t a = 0; a < kLabels; ++a)
      if (a != neighbour) costs[a] += x_graph.pair_costs[edge][labelPair(a, neighbour)];
  }

  const CrfGraph& x_graph;
  Incidence x_at;
  std::vector<LabelCosts> x_to_later, x_to_earlier;
};

std::array<float, kLabels> softmin(const LabelCosts& costs) {
  std::array<float, kLabels> shares;
  float sum = 0;
  for (std::size_t a = 0; a < kLabels; ++a) sum += shares[a] = std::exp(-costs[a]);
  for (float& share : shares) share /= sum;
  return shares;
}

}  // namespace

InferenceResult inferTrws(const CrfGraph& graph, const InferenceParams& params) {
  Trws solver(graph);
  InferenceResult result;
  for (unsigned sweep = 0; sweep < std::max(params.sweeps, 1U); ++sweep) {
    solver.passForward();
    result.lower_bound = solver.passBackward();
  }
  result.labels = solver.decode();
  result.marginals.reserve(graph.size());
  for (std::uint32_t i = 0; i < graph.size(); ++i) result.marginals.push_back(softmin(solver.minMarginals(i)));
  return result;
}

}  // namespace cluxel
