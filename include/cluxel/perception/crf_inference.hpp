// SPDX-License-Identifier: Apache-2.0
// Labels and marginals of a CRF by a fixed number of sequential message-passing sweeps.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cluxel/perception/crf_graph.hpp"

namespace cluxel {

struct InferenceParams {
  unsigned sweeps = 5;  ///< forward and backward passes, at least 1
  bool decode = true;   ///< false: marginals only, no labelling
};

struct InferenceResult {
  std::vector<std::uint8_t> labels;                                ///< the labelling found; empty unless decoded
  std::vector<std::array<float, kPrimitiveLabelCount>> marginals;  ///< scaled min-marginals, each sums to 1
  double lower_bound = 0;                                          ///< no labelling has less energy
};

/// Sequential tree-reweighted message passing (Kolmogorov 2006): nodes are visited by number, forth and back, `sweeps`
/// times; the labelling is read off on the last way forth; a node's marginals are exp(-min-marginal), normalised.
/// Exact on chains that are numbered along. Same input, same bits. Cost O(sweeps x edges x labels^2).
InferenceResult inferTrws(const CrfGraph& graph, const InferenceParams& params);

}  // namespace cluxel
