// SPDX-License-Identifier: Apache-2.0
// Labels and marginals of a CRF by a fixed number of sequential message-passing sweeps.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "perception/crf/crf_graph.hpp"

namespace cluxel::perception {

struct InferenceParams {
  unsigned sweeps = 5;  ///< pairs of a forward and a backward pass, at least 1
  bool decode = true;   ///< false: marginals only, no labelling
};

struct InferenceResult {
  std::vector<std::uint8_t> labels;                                      ///< the labelling found; empty unless decoded
  std::vector<std::array<float, scan::kPrimitiveLabelCount>> marginals;  ///< scaled min-marginals, each sums to 1
  double lower_bound = 0;  ///< lower bound of the energy of all labellings
};

/// Sequential tree-reweighted message passing (TRW-S, Kolmogorov 2006): visits nodes by number, forward and backward,
/// `sweeps` times. The labelling is decoded in the last forward pass. Marginals are exp(-min-marginal), normalised.
/// Exact on chains numbered along the chain. Deterministic. Cost O(sweeps x edges x labels^2).
InferenceResult inferTrws(const CrfGraph& graph, const InferenceParams& params);

}  // namespace cluxel::perception
