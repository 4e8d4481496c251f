// SPDX-License-Identifier: Apache-2.0
// Scores blocks of rows, transposed, so that each split is one comparison over a short array.
#include "cluxel/perception/unary_trees.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "perception/tree_scoring.hpp"
#include "perception/turned_rows.hpp"

namespace cluxel {

namespace {

static_assert(kTreeRows % kLanes == 0);

/// Some rows with their features column by column, and their sums.
class RowBlock {
 public:
  explicit RowBlock(std::size_t columns) : x_columns(columns), x_values(columns * kTreeRows, 0.0F) {}

  void fill(std::span<const float* const> rows) {
    const auto at = [&](std::size_t r) { return rows[std::min(r, rows.size() - 1)]; };  // the last one fills up
    for (std::size_t r = 0; r < rows.size(); r += kLanes)
      turnRows({at(r), at(r + 1), at(r + 2), at(r + 3)}, x_columns, x_values.data() + r, kTreeRows);
  }
  void score(const LabelValues& bias, const TreeTable& table, const LaneKernels& kernels,
             std::span<LabelValues> scores) {
    x_sums.fill({});
    for (auto& sums : x_sums)
      for (std::size_t k = 0; k < bias.size(); ++k) sums[k] = bias[k];
    kernels.add_trees(table, x_values.data(), x_sums.front().data());
    for (std::size_t r = 0; r < scores.size(); ++r)
      for (std::size_t k = 0; k < bias.size(); ++k) scores[r][k] = x_sums[r][k];
  }

 private:
  std::size_t x_columns;
  std::vector<float> x_values;
  std::array<std::array<float, kLeafRead>, kTreeRows> x_sums{};
};

}  // namespace

TreeScorer::TreeScorer(const TreeEnsemble& ensemble, const LaneKernels& kernels)
    : x_columns(ensemble.columns), x_bias(ensemble.bias), x_kernels(kernels) {
  for (const ObliviousTree& tree : ensemble.trees) {
    for (const TreeSplit& split : tree.splits) x_splits.push_back({split.column, split.threshold});
    x_split_begin.push_back(static_cast<std::uint32_t>(x_splits.size()));
    x_leaf_begin.push_back(static_cast<std::uint32_t>(x_leaves.size()));
    const std::size_t size = tree.leaves.size() * kPrimitiveLabelCount;
    static_assert(sizeof(LabelValues) == kPrimitiveLabelCount * sizeof(float));
    x_leaves.resize(x_leaves.size() + size);
    if (size > 0) std::memcpy(x_leaves.data() + x_leaf_begin.back(), tree.leaves.data(), size * sizeof(float));
  }
  static_assert(kPrimitiveLabelCount <= kLeafRead);
  x_leaves.resize(x_leaves.size() + kLeafRead);  // the last leaf is read beyond its end
}

TreeTable TreeScorer::table() const {
  return {x_splits.data(), x_split_begin.data(), x_leaves.data(), x_leaf_begin.data(), x_leaf_begin.size()};
}

std::vector<LabelValues> TreeScorer::score(std::span<const float* const> rows) const {
  std::vector<LabelValues> scores(rows.size());
  RowBlock block(x_columns);
  for (std::size_t begin = 0; begin < rows.size(); begin += kTreeRows) {
    const std::size_t count = std::min(kTreeRows, rows.size() - begin);
    block.fill(rows.subspan(begin, count));
    block.score(x_bias, table(), x_kernels, std::span(scores).subspan(begin, count));
  }
  return scores;
}

std::vector<LabelValues> TreeScorer::score(std::span<const float> features) const {
  if (x_columns == 0) return {};
  std::vector<const float*> rows(features.size() / x_columns);
  for (std::size_t r = 0; r < rows.size(); ++r) rows[r] = features.data() + r * x_columns;
  return score(rows);
}

std::vector<LabelValues> scoreRows(const TreeEnsemble& ensemble, std::span<const float* const> rows) {
  return TreeScorer(ensemble).score(rows);
}

std::vector<LabelValues> scoreRows(const TreeEnsemble& ensemble, std::span<const float> features) {
  return TreeScorer(ensemble).score(features);
}

LabelValues softmax(const LabelValues& scores) {
  const float most = *std::max_element(scores.begin(), scores.end());
  LabelValues shares;
  float sum = 0;
  for (std::size_t k = 0; k < scores.size(); ++k) sum += shares[k] = std::exp(scores[k] - most);
  for (float& share : shares) share /= sum;
  return shares;
}

}  // namespace cluxel
