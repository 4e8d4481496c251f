// SPDX-License-Identifier: Apache-2.0
// Oracles for inference: exact enumeration, alpha-expansion by max-flow; and random graphs.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "perception/crf/crf_graph.hpp"

namespace cluxel::oracle {

using namespace scan;
using namespace perception;

struct Labelling {
  std::vector<std::uint8_t> labels;
  double energy = 0;
};

/// The energy of a labelling: the sum of its unary and pair costs.
double energyOf(const CrfGraph& graph, std::span<const std::uint8_t> labels);

/// The best labelling of all 5^n.
Labelling enumerate(const CrfGraph& graph);

/// Min-marginals by enumeration: the minimum energy with node i at label a, minus the minimum energy.
std::vector<std::array<double, kPrimitiveLabelCount>> enumerateMinMarginals(const CrfGraph& graph);

/// Alpha-expansion (Boykov, Veksler, Zabih 2001) until no label's move lowers the energy. Pair costs that break the
/// triangle inequality are truncated within a move, and only moves that lower the true energy are taken.
Labelling expandAlpha(const CrfGraph& graph);

struct RandomGraph {
  std::size_t nodes = 8;
  double edge_probability = 0.4;
  float pair_strength = 1.0F;  ///< the largest pair cost
  bool potts = true;           ///< the same cost for all pairs of labels of an edge
};
CrfGraph randomGraph(std::mt19937& random, const RandomGraph& kind);

/// A chain of `nodes` numbered along.
CrfGraph randomChain(std::mt19937& random, std::size_t nodes);

/// A grid of side x side nodes with noisy costs around regions of one label: like cluxels of a street.
CrfGraph noisyGrid(std::mt19937& random, std::uint32_t side);

}  // namespace cluxel::oracle
