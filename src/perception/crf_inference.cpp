// SPDX-License-Identifier: Apache-2.0
// TRW-S over nodes in the order of their numbers. Messages live on edges, one for each direction.
#include "cluxel/perception/crf_inference.hpp"

#include <algorithm>
#include <cmath>

#include "perception/vector_lanes.hpp"

namespace cluxel {

namespace {

constexpr std::size_t kLabels = kPrimitiveLabelCount;

/// The edges at each node: those to later nodes are a range of the sorted edges, those to earlier ones are listed.
struct Incidence {
  std::vector<std::uint32_t> forward_begin;   // size + 1, into edges
  std::vector<std::uint32_t> backward_begin;  // size + 1, into backward
  std::vector<std::uint32_t> backward;        // edge numbers, ascending by `from`
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

/// Costs of the labels: the first four in a vector, the last one apart.
struct Costs {
  Floats most;
  float last;

  void add(const LabelCosts& term) {
    most += loadFloats(term.data());
    last += term[kLanes];
  }
  float subtractMin() {
    const float least = std::min(leastOf(most), last);
    most -= least;
    last -= least;
    return least;
  }
  void store(LabelCosts& to) const {
    storeFloats(most, to.data());
    to[kLanes] = last;
  }
};
static_assert(kLabels == kLanes + 1, "a vector holds all labels but one");

Costs costsOf(const LabelCosts& costs) {
  return {loadFloats(costs.data()), costs[kLanes]};
}

/// The costs of one edge as rows of a matrix: row a holds V(a, b) for b of 0 to 3; the last row is that of label 4.
using PairRows = std::array<Floats, kLabels>;

PairRows rowsOf(const PairCosts& pair) {
  const auto [p01, p02, p03, p04, p12, p13, p14, p23, p24, p34] = pair;
  return {Floats{0, p01, p02, p03}, Floats{p01, 0, p12, p13}, Floats{p02, p12, 0, p23}, Floats{p03, p13, p23, 0},
          Floats{p04, p14, p24, p34}};
}

/// min over a of from[a] + V(a, b), for each b.
[[gnu::always_inline]] inline Costs minSum(const Costs& from, const PairRows& pair) {
  const Floats& most = from.most;
  const Floats by_0 = __builtin_shufflevector(most, most, 0, 0, 0, 0) + pair[0];
  const Floats by_1 = __builtin_shufflevector(most, most, 1, 1, 1, 1) + pair[1];
  const Floats by_2 = __builtin_shufflevector(most, most, 2, 2, 2, 2) + pair[2];
  const Floats by_3 = __builtin_shufflevector(most, most, 3, 3, 3, 3) + pair[3];
  const Floats best = lesserOf(lesserOf(by_0, by_1), lesserOf(by_2, by_3));
  return {lesserOf(best, from.last + pair[4]), std::min(from.last, leastOf(most + pair[4]))};
}

class Trws {
 public:
  explicit Trws(const CrfGraph& graph)
      : x_graph(graph),
        x_at(incidenceOf(graph)),
        x_to_later(graph.edges.size()),
        x_to_earlier(graph.edges.size()),
        x_from_earlier(graph.size()),
        x_min_marginals(graph.size()) {
    x_pairs.reserve(graph.edges.size());
    for (const PairCosts& pair : graph.pair_costs) x_pairs.push_back(rowsOf(pair));
  }

  void passForward() {
    for (std::uint32_t i = 0; i < x_graph.size(); ++i) {
      Costs costs = costsOf(x_graph.unary[i]);
      addFromEarlier(i, costs);
      costs.store(x_from_earlier[i]);  // the same on the way back
      addFromLater(i, costs);
      sendForward(i, costs);
    }
  }

  /// Returns the lower bound that the messages prove.
  double passBackward() {
    double bound = 0;
    for (std::uint32_t i = static_cast<std::uint32_t>(x_graph.size()); i-- > 0;) {
      Costs costs = costsOf(x_from_earlier[i]);
      addFromLater(i, costs);
      bound += static_cast<double>(costs.subtractMin());
      costs.store(x_min_marginals[i]);  // no message to this node will change before the next pass
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
      for (std::uint32_t e = x_at.forward_begin[i]; e < x_at.forward_begin[i + 1]; ++e)
        for (std::size_t a = 0; a < kLabels; ++a) costs[a] += x_to_earlier[e][a];
      labels[i] = static_cast<std::uint8_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
    }
    return labels;
  }

  /// The min-marginals of each node, summed over the trees through it, as the last pass backward found them.
  const std::vector<LabelCosts>& minMarginals() const { return x_min_marginals; }

 private:
  void addFromEarlier(std::uint32_t i, Costs& costs) const {
    for (std::uint32_t k = x_at.backward_begin[i]; k < x_at.backward_begin[i + 1]; ++k)
      costs.add(x_to_later[x_at.backward[k]]);
  }
  void addFromLater(std::uint32_t i, Costs& costs) const {
    for (std::uint32_t e = x_at.forward_begin[i]; e < x_at.forward_begin[i + 1]; ++e) costs.add(x_to_earlier[e]);
  }

  /// One over the number of monotonic chains through a node.
  float treeShare(std::uint32_t i) const {
    const std::uint32_t later = x_at.forward_begin[i + 1] - x_at.forward_begin[i];
    const std::uint32_t earlier = x_at.backward_begin[i + 1] - x_at.backward_begin[i];
    return 1.0F / static_cast<float>(std::max({later, earlier, 1U}));
  }

  /// What an edge carries on: the tree's share of the belief, without what came along the edge itself; its least is
  /// taken off and returned.
  [[gnu::always_inline]] static float send(const Costs& belief, float share, const LabelCosts& received,
                                           const PairRows& pair, LabelCosts& sent) {
    const Costs back = costsOf(received);
    Costs message = minSum({share * belief.most - back.most, share * belief.last - back.last}, pair);
    const float least = message.subtractMin();
    message.store(sent);
    return least;
  }

  void sendForward(std::uint32_t i, const Costs& costs) {
    const float share = treeShare(i);
    for (std::uint32_t e = x_at.forward_begin[i]; e < x_at.forward_begin[i + 1]; ++e)
      send(costs, share, x_to_earlier[e], x_pairs[e], x_to_later[e]);
  }

  /// Edges to earlier nodes lie here and there: those that come next on the way back are called into the cache.
  void prefetchBackward(std::uint32_t k) const {
    constexpr std::uint32_t kAhead = 12;
    if (k < kAhead) return;
    const std::uint32_t e = x_at.backward[k - kAhead];
    __builtin_prefetch(&x_pairs[e]);
    __builtin_prefetch(&x_pairs[e].back());
    __builtin_prefetch(&x_to_later[e]);
    __builtin_prefetch(&x_to_earlier[e]);
  }

  double sendBackward(std::uint32_t i, const Costs& costs) {
    const float share = treeShare(i);
    double bound = 0;
    for (std::uint32_t k = x_at.backward_begin[i]; k < x_at.backward_begin[i + 1]; ++k) {
      const std::uint32_t e = x_at.backward[k];
      prefetchBackward(k);
      bound += static_cast<double>(send(costs, share, x_to_later[e], x_pairs[e], x_to_earlier[e]));
    }
    return bound;
  }

  void addFixed(LabelCosts& costs, std::uint32_t edge, std::uint8_t neighbour) const {
    for (std::size_t a = 0; a < kLabels; ++a)
      if (a != neighbour) costs[a] += x_graph.pair_costs[edge][labelPair(a, neighbour)];
  }

  const CrfGraph& x_graph;
  Incidence x_at;
  std::vector<PairRows> x_pairs;
  std::vector<LabelCosts> x_to_later, x_to_earlier;
  std::vector<LabelCosts> x_from_earlier;  ///< unary costs and what earlier nodes said on the last way forth
  std::vector<LabelCosts> x_min_marginals;
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
  if (params.decode) result.labels = solver.decode();
  result.marginals.reserve(graph.size());
  for (const LabelCosts& costs : solver.minMarginals()) result.marginals.push_back(softmin(costs));
  return result;
}

}  // namespace cluxel
