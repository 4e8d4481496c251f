// SPDX-License-Identifier: Apache-2.0
// The CRF of a tile and its halo: nodes in canonical order, edges once each, costs from a model.
#pragma once

#include <cstdint>
#include <vector>

#include "perception/crf/crf_graph.hpp"
#include "perception/crf/label_model.hpp"
#include "perception/crf/pair_cost_table.hpp"
#include "perception/features/feature_tile.hpp"

namespace cluxel::perception {

/// A cluxel of the ring.
struct HaloNode {
  std::uint32_t ring = 0, index = 0;
};

/// One edge between nodes, with the location of its features.
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

/// Pointers to the feature row of each node.
std::vector<const float*> nodeFeatures(const Ring<FeatureTile>& ring, const HaloGraph& graph, std::size_t columns);

/// Converts scores of the unary model (log-probabilities up to a constant) and edge features into the costs of a CRF.
CrfGraph crfGraph(const Ring<FeatureTile>& ring, const HaloGraph& structure, const std::vector<LabelValues>& scores,
                  const PairModel& pairs);

}  // namespace cluxel::perception
