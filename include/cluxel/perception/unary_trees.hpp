// SPDX-License-Identifier: Apache-2.0
// The unary term: boosted oblivious trees, which score every label of a cluxel from its row of features.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cluxel/scan/primitive_label.hpp"

namespace cluxel {

/// One number per primitive label: log-odds, probabilities or weights, as the place says.
using LabelValues = std::array<float, kPrimitiveLabelCount>;

/// Deepest tree that a model may hold.
inline constexpr std::size_t kLargestTreeDepth = 8;

/// A question that all nodes of one level share: is the value of `column` above `threshold`? (NaN is not.)
struct TreeSplit {
  std::uint32_t column = 0;
  float threshold = 0;
};

/// Bit d of a leaf's number is the answer to split d.
struct ObliviousTree {
  std::vector<TreeSplit> splits;
  std::vector<LabelValues> leaves;  ///< 2^splits rows of log-odds
};

/// The sum of all trees' leaves, on top of `bias`. Splits shared by a level make trees shallow tables: rows are scored
/// in blocks without a branch, and few degrees of freedom per tree keep them from learning one sensor's habits by
/// heart.
struct TreeEnsemble {
  std::uint32_t columns = 0;  ///< features per row
  LabelValues bias{};
  std::vector<ObliviousTree> trees;
};

/// Log-odds of the labels for each row of `features` (rows x ensemble.columns, row-major). The score of a row does not
/// depend on the rows around it. Cost: about 0.4 us a row for 200 trees of depth 6.
std::vector<LabelValues> scoreRows(const TreeEnsemble& ensemble, std::span<const float> features);
/// The same for rows that stand apart: `rows` tells where each begins.
std::vector<LabelValues> scoreRows(const TreeEnsemble& ensemble, std::span<const float* const> rows);

/// exp(scores), normalised.
LabelValues softmax(const LabelValues& scores);

}  // namespace cluxel
