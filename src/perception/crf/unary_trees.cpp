// SPDX-License-Identifier: Apache-2.0
// Scores blocks of transposed rows, so that each split is one vector comparison.
#include "perception/crf/unary_trees.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "perception/crf/transposed_rows.hpp"
#include "perception/crf/tree_scoring.hpp"

namespace cluxel::perception {

namespace {

static_assert(kTreeRows % kLanes == 0);

/// A block of rows with column-major features, and their sums.
class RowBlock {
 public:
  explicit RowBlock(std::size_t columns) : columns_(columns), values_(columns * kTreeRows, 0.0F) {}

  void fill(std::span<const float* const> rows) {
    const auto at = [&](std::size_t r) { return rows[std::min(r, rows.size() - 1)]; };  // padding repeats the last one
    for (std::size_t r = 0; r < rows.size(); r += kLanes)
      transposeRows({at(r), at(r + 1), at(r + 2), at(r + 3)}, columns_, values_.data() + r, kTreeRows);
  }
  void score(const LabelValues& bias, const TreeTable& table, const SimdKernels& kernels,
             std::span<LabelValues> scores) {
    sums_.fill({});
    for (auto& sums : sums_)
      for (std::size_t k = 0; k < bias.size(); ++k) sums[k] = bias[k];
    kernels.add_trees(table, values_.data(), sums_.front().data());
    for (std::size_t r = 0; r < scores.size(); ++r)
      for (std::size_t k = 0; k < bias.size(); ++k) scores[r][k] = sums_[r][k];
  }

 private:
  std::size_t columns_;
  std::vector<float> values_;
  std::array<std::array<float, kLeafRead>, kTreeRows> sums_{};
};

}  // namespace

TreeScorer::TreeScorer(const TreeEnsemble& ensemble, const SimdKernels& kernels)
    : columns_(ensemble.columns), bias_(ensemble.bias), kernels_(kernels) {
  for (const ObliviousTree& tree : ensemble.trees) {
    for (const TreeSplit& split : tree.splits) splits_.push_back({split.column, split.threshold});
    split_begin_.push_back(static_cast<std::uint32_t>(splits_.size()));
    leaf_begin_.push_back(static_cast<std::uint32_t>(leaves_.size()));
    const std::size_t size = tree.leaves.size() * scan::kPrimitiveLabelCount;
    static_assert(sizeof(LabelValues) == scan::kPrimitiveLabelCount * sizeof(float));
    leaves_.resize(leaves_.size() + size);
    if (size > 0) std::memcpy(leaves_.data() + leaf_begin_.back(), tree.leaves.data(), size * sizeof(float));
  }
  static_assert(scan::kPrimitiveLabelCount <= kLeafRead);
  leaves_.resize(leaves_.size() + kLeafRead);  // padding: the last leaf is read past its end
}

TreeTable TreeScorer::table() const {
  return {splits_.data(), split_begin_.data(), leaves_.data(), leaf_begin_.data(), leaf_begin_.size()};
}

std::vector<LabelValues> TreeScorer::score(std::span<const float* const> rows) const {
  std::vector<LabelValues> scores(rows.size());
  RowBlock block(columns_);
  for (std::size_t begin = 0; begin < rows.size(); begin += kTreeRows) {
    const std::size_t count = std::min(kTreeRows, rows.size() - begin);
    block.fill(rows.subspan(begin, count));
    block.score(bias_, table(), kernels_, std::span(scores).subspan(begin, count));
  }
  return scores;
}

std::vector<LabelValues> TreeScorer::score(std::span<const float> features) const {
  if (columns_ == 0) return {};
  std::vector<const float*> rows(features.size() / columns_);
  for (std::size_t r = 0; r < rows.size(); ++r) rows[r] = features.data() + r * columns_;
  return score(rows);
}

std::vector<LabelValues> scoreRows(const TreeEnsemble& ensemble, std::span<const float* const> rows) {
  return TreeScorer(ensemble).score(rows);
}

std::vector<LabelValues> scoreRows(const TreeEnsemble& ensemble, std::span<const float> features) {
  return TreeScorer(ensemble).score(features);
}

LabelValues softmax(const LabelValues& scores) {
  const float highest = *std::max_element(scores.begin(), scores.end());
  LabelValues shares;
  float sum = 0;
  for (std::size_t k = 0; k < scores.size(); ++k) sum += shares[k] = std::exp(scores[k] - highest);
  for (float& share : shares) share /= sum;
  return shares;
}

}  // namespace cluxel::perception
