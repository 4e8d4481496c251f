// SPDX-License-Identifier: Apache-2.0
// An ensemble laid out for the kernels: made once, asked for every tile.
#pragma once

#include "cluxel/perception/unary_trees.hpp"
#include "perception/lane_kernels.hpp"

namespace cluxel {

/// Scores rows as scoreRows() does, with the kernels of one's choice: the same bits with any.
class TreeScorer {
 public:
  explicit TreeScorer(const TreeEnsemble& ensemble, const LaneKernels& kernels = fastestKernels());
  /// `rows` tells where each row begins.
  std::vector<LabelValues> score(std::span<const float* const> rows) const;
  /// Rows one behind the other.
  std::vector<LabelValues> score(std::span<const float> features) const;

 private:
  TreeTable table() const;

  std::size_t x_columns;
  LabelValues x_bias;
  LaneKernels x_kernels;
  std::vector<TreeTable::Split> x_splits;
  std::vector<std::uint32_t> x_split_begin{0}, x_leaf_begin;
  std::vector<float> x_leaves;
};

}  // namespace cluxel
