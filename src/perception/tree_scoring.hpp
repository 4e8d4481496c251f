// SPDX-License-Identifier: Apache-2.0
// Scoring with the kernels of one's choice: the same bits with any.
#pragma once

#include "cluxel/perception/unary_trees.hpp"
#include "perception/lane_kernels.hpp"

namespace cluxel {

std::vector<LabelValues> scoreRows(const TreeEnsemble& ensemble, std::span<const float> features, const LaneKernels& kernels);

}  // namespace cluxel
