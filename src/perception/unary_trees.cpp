// SPDX-License-Identifier: Apache-2.0
// Scores blocks of rows, transposed, so that each split is one comparison over a short array.
#include "cluxel/perception/unary_trees.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel {

namespace {

constexpr std::size_t kBlock = 128;

/// Some rows with their features column by column.
class RowBlock {
 public:
  explicit RowBlock(std::size_t columns) : x_columns(columns), x_values(columns * kBlock, 0.0F) {}

  void fill(std::span<const float> rows) {
    x_rows = rows.size() / x_columns;
    for (std::size_t r = 0; r < x_rows; ++r)
      for (std::size_t c = 0; c < x_columns; ++c) x_values[c * kBlock + r] = rows[r * x_columns + c];
  }

  void addTree(const ObliviousTree& tree, std::span<LabelValues> scores) {
    x_leaf.fill(0);
    for (std::size_t d = 0; d < tree.splits.size(); ++d) ask(tree.splits[d], d);
    for (std::size_t r = 0; r < x_rows; ++r) {
      const LabelValues& leaf = tree.leaves[x_leaf[r]];
      for (std::size_t k = 0; k < kPrimitiveLabelCount; ++k) scores[r][k] += leaf[k];
    }
  }

 private:
  void ask(const TreeSplit& split, std::size_t level) {
    const float* values = x_values.data() + split.column * kBlock;
    const auto bit = static_cast<std::uint32_t>(1U << level);
    for (std::size_t r = 0; r < kBlock; ++r) x_leaf[r] |= values[r] > split.threshold ? bit : 0U;
  }

  std::size_t x_columns, x_rows = 0;
  std::vector<float> x_values;
  std::array<std::uint32_t, kBlock> x_leaf{};
};

}  // namespace

std::vector<LabelValues> scoreRows(const TreeEnsemble& ensemble, std::span<const float> features) {
  if (ensemble.columns == 0) return {};
  const std::size_t rows = features.size() / ensemble.columns;
  std::vector<LabelValues> scores(rows, ensemble.bias);
  RowBlock block(ensemble.columns);
  for (std::size_t begin = 0; begin < rows; begin += kBlock) {
    const std::size_t count = std::min(kBlock, rows - begin);
    block.fill(features.subspan(begin * ensemble.columns, count * ensemble.columns));
    for (const ObliviousTree& tree : ensemble.trees) block.addTree(tree, std::span(scores).subspan(begin, count));
  }
  return scores;
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
