// SPDX-License-Identifier: Apache-2.0
// The CRF of a tile and its halo: nodes in canonical order, edges once each, costs from a model.
#pragma once

#include <cstdint>
#include <vector>

#include "cluxel/perception/crf_graph.hpp"
#include "cluxel/perception/feature_tile.hpp"
#include "cluxel/perception/label_model.hpp"

namespace cluxel {

/// A cluxel of the ring.
struct HaloNode {
  std::uint32_t ring = 0, index = 0;
};

/// One edge between nodes, with where its features stand.
struct HaloEdge {
  CrfEdge ends;
  std::uint32_t ring = 0, number = 0;   ///< edge `number` of tile `ring`
  float share = 1;                      ///< 2 / (degree + degree), over all edges of both cluxels
};

/// Structure without costs. Nodes are ordered by ring tile and number; a tile's own cluxels are a range.
struct HaloGraph {
  std::vector<HaloNode> nodes;
  std::vector<HaloEdge> edges;          ///< ascending by ends
  std::uint32_t own_begin = 0, own_end = 0;
};
HaloGraph haloGraph(const Ring<FeatureTile>& ring, double halo_m);

/// Features of the nodes, row by row.
std::vector<float> nodeFeatures(const Ring<FeatureTile>& ring, const HaloGraph& graph, std::size_t columns);

/// Log-probabilities of the unary, as scores of any unary model, turned into the costs of a CRF.
CrfGraph crfGraph(const Ring<FeatureTile>& ring, const HaloGraph& structure, const std::vector<LabelValues>& scores,
                  const PairModel& pairs);

}  // namespace cluxel
