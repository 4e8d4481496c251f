// SPDX-License-Identifier: Apache-2.0
// The energy of a labelling, term by term.
#include "cluxel/perception/crf_graph.hpp"

namespace cluxel {

static_assert(labelPair(0, 1) == 0 && labelPair(4, 3) == kLabelPairCount - 1 && labelPair(2, 1) == 4);

double energyOf(const CrfGraph& graph, std::span<const std::uint8_t> labels) {
  double energy = 0;
  for (std::size_t i = 0; i < graph.size(); ++i) energy += static_cast<double>(graph.unary[i][labels[i]]);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const std::uint8_t a = labels[graph.edges[e].from], b = labels[graph.edges[e].to];
    if (a != b) energy += static_cast<double>(graph.pair_costs[e][labelPair(a, b)]);
  }
  return energy;
}

}  // namespace cluxel
