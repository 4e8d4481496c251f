// SPDX-License-Identifier: Apache-2.0
// A tree ensemble in the memory layout of the SIMD kernels: prepared once, used for every tile.
#pragma once

#include "perception/crf/simd_kernels.hpp"
#include "perception/crf/unary_trees.hpp"

namespace cluxel::perception {

/// Scores rows as scoreRows() does. All kernels give the same bits.
class TreeScorer {
 public:
  explicit TreeScorer(const TreeEnsemble& ensemble, const SimdKernels& kernels = fastestKernels());
  /// `rows` points to the first value of each row.
  std::vector<LabelValues> score(std::span<const float* const> rows) const;
  /// Contiguous rows.
  std::vector<LabelValues> score(std::span<const float> features) const;

 private:
  TreeTable table() const;

  std::size_t columns_;
  LabelValues bias_;
  SimdKernels kernels_;
  std::vector<TreeTable::Split> splits_;
  std::vector<std::uint32_t> split_begin_{0}, leaf_begin_;
  std::vector<float> leaves_;
};

}  // namespace cluxel::perception
