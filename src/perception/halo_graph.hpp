// SPDX-License-Identifier: Apache-2.0
// The CRF of a tile and its halo: nodes in canonical order, edges once each, costs from a model.
#pragma once

#include <cstdint>
#include <vector>

#include "cluxel/perception/crf_graph.hpp"
#include "cluxel/perception/feature_tile.hpp"
#include "cluxel/perception/label_model.hpp"
#include "perception/pair_cost_table.hpp"

namespace cluxel {

/// A cluxel of the ring.
struct HaloNode {
  std::uint32_t ring = 0, index = 0;
};

/// One edge between nodes, with where its features stand.
struct HaloEdge {
  CrfEdge ends;
  std::uint32_t ring = 0, row = 0;  ///< row `row` of the edge features of tile `ring`
  std::uint32_t degrees = 0;        ///< of both cluxels together, over all their edges
  float share() const { return shareOf(degrees); }
};

/// Structure without costs. Nodes are ordered by ring tile and number; a tile's own cluxels are a range.
struct HaloGraph {
  std::vector<HaloNode> nodes;
  std::vector<HaloEdge> edges;  ///< ascending by ends
  std::uint32_t own_begin = 0, own_end = 0;
};
HaloGraph haloGraph(const Ring<FeatureTile>& ring, double halo_m);

/// Where the features of each node stand.
std::vector<const float*> nodeFeatures(const Ring<FeatureTile>& ring, const HaloGraph& graph, std::size_t columns);

/// Log-probabilities of the unary, as scores of any unary model, turned into the costs of a CRF.
CrfGraph crfGraph(const Ring<FeatureTile>& ring, const HaloGraph& structure, const std::vector<LabelValues>& scores,
                  const PairModel& pairs);

}  // namespace cluxel
