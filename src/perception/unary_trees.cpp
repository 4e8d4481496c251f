// SPDX-License-Identifier: Apache-2.0
// Scores blocks of rows, transposed, so that each split is one comparison over a short array.
#include "cluxel/perception/unary_trees.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "perception/vector_lanes.hpp"

namespace cluxel {

namespace {

/// Rows scored together: their columns fit into the nearest cache.
constexpr std::size_t kBlock = 64;
/// Trees whose leaves are added in one go, so that a row's sums stay in registers.
constexpr std::size_t kTogether = 10;

using LeafNumbers = std::array<std::int32_t, kBlock>;

/// Some rows with their features column by column.
class RowBlock {
 public:
  explicit RowBlock(std::size_t columns) : x_columns(columns), x_values(columns * kBlock, 0.0F) {}

  void fill(std::span<const float* const> rows) {
    for (std::size_t r = 0; r < rows.size(); ++r)
      for (std::size_t c = 0; c < x_columns; ++c) x_values[c * kBlock + r] = rows[r][c];
  }

  /// The leaf of each row, its bits from the last split to the first.
  LeafNumbers leavesOf(const ObliviousTree& tree) const {
    LeafNumbers leaves;
    for (std::size_t r = 0; r < kBlock; r += 4 * kLanes) {
      std::array<Numbers, 4> leaf{};
      for (std::size_t d = tree.splits.size(); d-- > 0;) {
        const float* values = x_values.data() + tree.splits[d].column * kBlock + r;
        const float threshold = tree.splits[d].threshold;
        for (std::size_t i = 0; i < leaf.size(); ++i)
          leaf[i] = leaf[i] + leaf[i] - (loadFloats(values + i * kLanes) > threshold);
      }
      std::memcpy(leaves.data() + r, leaf.data(), sizeof leaf);
    }
    return leaves;
  }

 private:
  std::size_t x_columns;
  std::vector<float> x_values;
};

/// Adds the leaves of up to kTogether trees to each row's scores, tree by tree.
void addLeaves(std::span<const ObliviousTree> trees, const std::array<LeafNumbers, kTogether>& leaves,
               std::span<LabelValues> scores) {
  std::array<const LabelValues*, kTogether> tables{};
  for (std::size_t t = 0; t < trees.size(); ++t) tables[t] = trees[t].leaves.data();
  for (std::size_t r = 0; r < scores.size(); ++r) {
    LabelValues sum = scores[r];
    for (std::size_t t = 0; t < trees.size(); ++t) {
      const LabelValues& leaf = tables[t][static_cast<std::size_t>(leaves[t][r])];
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += leaf[k];
    }
    scores[r] = sum;
  }
}

}  // namespace

std::vector<LabelValues> scoreRows(const TreeEnsemble& ensemble, std::span<const float* const> rows) {
  std::vector<LabelValues> scores(rows.size(), ensemble.bias);
  RowBlock block(ensemble.columns);
  std::array<LeafNumbers, kTogether> leaves;
  const std::span<const ObliviousTree> trees(ensemble.trees);
  for (std::size_t begin = 0; begin < rows.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, rows.size() - begin);
    block.fill(rows.subspan(begin, count));
    for (std::size_t first = 0; first < trees.size(); first += kTogether) {
      const auto some = trees.subspan(first, std::min(kTogether, trees.size() - first));
      for (std::size_t t = 0; t < some.size(); ++t) leaves[t] = block.leavesOf(some[t]);
      addLeaves(some, leaves, std::span(scores).subspan(begin, count));
    }
  }
  return scores;
}

std::vector<LabelValues> scoreRows(const TreeEnsemble& ensemble, std::span<const float> features) {
  if (ensemble.columns == 0) return {};
  std::vector<const float*> rows(features.size() / ensemble.columns);
  for (std::size_t r = 0; r < rows.size(); ++r) rows[r] = features.data() + r * ensemble.columns;
  return scoreRows(ensemble, rows);
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
