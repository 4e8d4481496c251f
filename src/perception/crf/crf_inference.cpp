// SPDX-License-Identifier: Apache-2.0
// TRW-S over nodes in the order of their numbers. Each edge stores one message per direction.
#include "perception/crf/crf_inference.hpp"

#include <algorithm>
#include <cmath>

#include "perception/simd_vector.hpp"

namespace cluxel::perception {

namespace {

/// The edges at each node: edges to later nodes are a range of the sorted edges, edges to earlier nodes are listed.
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

/// Costs of the labels: the first four in a SIMD vector (`first_four`), the last one as a scalar.
struct Costs {
  Floats first_four;
  float last;

  void add(const LabelCosts& term) {
    first_four += loadFloats(term.data());
    last += term[kLanes];
  }
  float subtractMin() {
    const float min = std::min(minOf(first_four), last);
    first_four -= min;
    last -= min;
    return min;
  }
  void store(LabelCosts& to) const {
    storeFloats(first_four, to.data());
    to[kLanes] = last;
  }
};
static_assert(scan::kPrimitiveLabelCount == kLanes + 1, "a vector holds all labels but one");

Costs costsOf(const LabelCosts& costs) {
  return {loadFloats(costs.data()), costs[kLanes]};
}

/// The costs of one edge as rows of a matrix: row a holds V(a, b) for b of 0 to 3; the last row is that of label 4.
using PairRows = std::array<Floats, scan::kPrimitiveLabelCount>;

PairRows rowsOf(const PairCosts& pair) {
  const auto [p01, p02, p03, p04, p12, p13, p14, p23, p24, p34] = pair;
  return {Floats{0, p01, p02, p03}, Floats{p01, 0, p12, p13}, Floats{p02, p12, 0, p23}, Floats{p03, p13, p23, 0},
          Floats{p04, p14, p24, p34}};
}

/// min over a of from[a] + V(a, b), for each b.
[[gnu::always_inline]] inline Costs minSum(const Costs& from, const PairRows& pair) {
  const Floats& first_four = from.first_four;
  const Floats by_0 = __builtin_shufflevector(first_four, first_four, 0, 0, 0, 0) + pair[0];
  const Floats by_1 = __builtin_shufflevector(first_four, first_four, 1, 1, 1, 1) + pair[1];
  const Floats by_2 = __builtin_shufflevector(first_four, first_four, 2, 2, 2, 2) + pair[2];
  const Floats by_3 = __builtin_shufflevector(first_four, first_four, 3, 3, 3, 3) + pair[3];
  const Floats best = minimum(minimum(by_0, by_1), minimum(by_2, by_3));
  return {minimum(best, from.last + pair[4]), std::min(from.last, minOf(first_four + pair[4]))};
}

class Trws {
 public:
  explicit Trws(const CrfGraph& graph)
      : graph_(graph),
        at_(incidenceOf(graph)),
        to_later_(graph.edges.size()),
        to_earlier_(graph.edges.size()),
        from_earlier_(graph.size()),
        min_marginals_(graph.size()) {
    pairs_.reserve(graph.edges.size());
    for (const PairCosts& pair : graph.pair_costs) pairs_.push_back(rowsOf(pair));
  }

  void passForward() {
    for (std::uint32_t i = 0; i < graph_.size(); ++i) {
      Costs costs = costsOf(graph_.unary[i]);
      addFromEarlier(i, costs);
      costs.store(from_earlier_[i]);  // unchanged during the backward pass
      addFromLater(i, costs);
      sendForward(i, costs);
    }
  }

  /// Returns the lower bound given by the messages.
  double passBackward() {
    double bound = 0;
    for (std::uint32_t i = static_cast<std::uint32_t>(graph_.size()); i-- > 0;) {
      Costs costs = costsOf(from_earlier_[i]);
      addFromLater(i, costs);
      bound += static_cast<double>(costs.subtractMin());
      costs.store(min_marginals_[i]);  // messages to this node do not change before the next pass
      bound += sendBackward(i, costs);
    }
    return bound;
  }

  /// The last forward pass: each node takes the best label given the labels of earlier nodes.
  std::vector<std::uint8_t> decode() {
    std::vector<std::uint8_t> labels(graph_.size());
    for (std::uint32_t i = 0; i < graph_.size(); ++i) {
      LabelCosts costs = graph_.unary[i];
      for (std::uint32_t k = at_.backward_begin[i]; k < at_.backward_begin[i + 1]; ++k)
        addFixed(costs, at_.backward[k], labels[graph_.edges[at_.backward[k]].from]);
      for (std::uint32_t e = at_.forward_begin[i]; e < at_.forward_begin[i + 1]; ++e)
        for (std::size_t a = 0; a < scan::kPrimitiveLabelCount; ++a) costs[a] += to_earlier_[e][a];
      labels[i] = static_cast<std::uint8_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
    }
    return labels;
  }

  /// The min-marginals of each node from the last backward pass, summed over the trees through it.
  const std::vector<LabelCosts>& minMarginals() const { return min_marginals_; }

 private:
  void addFromEarlier(std::uint32_t i, Costs& costs) const {
    for (std::uint32_t k = at_.backward_begin[i]; k < at_.backward_begin[i + 1]; ++k)
      costs.add(to_later_[at_.backward[k]]);
  }
  void addFromLater(std::uint32_t i, Costs& costs) const {
    for (std::uint32_t e = at_.forward_begin[i]; e < at_.forward_begin[i + 1]; ++e) costs.add(to_earlier_[e]);
  }

  /// 1 / (number of monotonic chains through a node).
  float treeShare(std::uint32_t i) const {
    const std::uint32_t later = at_.forward_begin[i + 1] - at_.forward_begin[i];
    const std::uint32_t earlier = at_.backward_begin[i + 1] - at_.backward_begin[i];
    return 1.0F / static_cast<float>(std::max({later, earlier, 1U}));
  }

  /// The new message of an edge: the tree's share of the belief minus the message in the opposite direction. Subtracts
  /// the minimum from the message and returns it.
  [[gnu::always_inline]] static float send(const Costs& belief, float share, const LabelCosts& received,
                                           const PairRows& pair, LabelCosts& sent) {
    const Costs back = costsOf(received);
    Costs message = minSum({share * belief.first_four - back.first_four, share * belief.last - back.last}, pair);
    const float min = message.subtractMin();
    message.store(sent);
    return min;
  }

  void sendForward(std::uint32_t i, const Costs& costs) {
    const float share = treeShare(i);
    for (std::uint32_t e = at_.forward_begin[i]; e < at_.forward_begin[i + 1]; ++e)
      send(costs, share, to_earlier_[e], pairs_[e], to_later_[e]);
  }

  double sendBackward(std::uint32_t i, const Costs& costs) {
    const float share = treeShare(i);
    double bound = 0;
    for (std::uint32_t k = at_.backward_begin[i]; k < at_.backward_begin[i + 1]; ++k) {
      const std::uint32_t e = at_.backward[k];
      bound += static_cast<double>(send(costs, share, to_later_[e], pairs_[e], to_earlier_[e]));
    }
    return bound;
  }

  void addFixed(LabelCosts& costs, std::uint32_t edge, std::uint8_t neighbour) const {
    for (std::size_t a = 0; a < scan::kPrimitiveLabelCount; ++a)
      if (a != neighbour) costs[a] += graph_.pair_costs[edge][labelPair(a, neighbour)];
  }

  const CrfGraph& graph_;
  Incidence at_;
  std::vector<PairRows> pairs_;
  std::vector<LabelCosts> to_later_, to_earlier_;
  std::vector<LabelCosts> from_earlier_;  ///< unary costs plus the messages of earlier nodes in the last forward pass
  std::vector<LabelCosts> min_marginals_;
};

std::array<float, scan::kPrimitiveLabelCount> softmin(const LabelCosts& costs) {
  std::array<float, scan::kPrimitiveLabelCount> shares;
  float sum = 0;
  for (std::size_t a = 0; a < scan::kPrimitiveLabelCount; ++a) sum += shares[a] = std::exp(-costs[a]);
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

}  // namespace cluxel::perception
