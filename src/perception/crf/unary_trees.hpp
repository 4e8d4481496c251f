// SPDX-License-Identifier: Apache-2.0
// The unary term: boosted oblivious trees that score every label of a cluxel from its row of features.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scan/truth/primitive_label.hpp"

namespace cluxel::perception {

/// One number per primitive label: log-odds, probabilities or weights.
using LabelValues = std::array<float, scan::kPrimitiveLabelCount>;

/// The largest depth of a tree.
inline constexpr std::size_t kMaxTreeDepth = 8;

/// The split shared by all nodes of one level: is the value of `column` above `threshold`? (False for NaN.)
struct TreeSplit {
  std::uint32_t column = 0;
  float threshold = 0;
};

/// Bit d of a leaf's index is the result of split d.
struct ObliviousTree {
  std::vector<TreeSplit> splits;
  std::vector<LabelValues> leaves;  ///< 2^splits rows of log-odds
};

/// The score is `bias` plus the leaves of all trees. Since splits are shared by a level (oblivious trees), rows are
/// scored in blocks without branches, and few degrees of freedom per tree limit overfitting to one sensor.
struct TreeEnsemble {
  std::uint32_t columns = 0;  ///< features per row
  LabelValues bias{};
  std::vector<ObliviousTree> trees;
};

/// Log-odds of the labels for each row of `features` (rows x ensemble.columns, row-major). The score of a row does not
/// depend on the rows around it. Cost: about 0.4 us a row for 200 trees of depth 6.
std::vector<LabelValues> scoreRows(const TreeEnsemble& ensemble, std::span<const float> features);
/// The same for scattered rows: `rows` points to the first value of each.
std::vector<LabelValues> scoreRows(const TreeEnsemble& ensemble, std::span<const float* const> rows);

/// exp(scores), normalised.
LabelValues softmax(const LabelValues& scores);

}  // namespace cluxel::perception
