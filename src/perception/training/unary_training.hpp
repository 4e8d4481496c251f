// SPDX-License-Identifier: Apache-2.0
// Grows boosted oblivious trees from rows of features with weighted labels.
#pragma once

#include <cstdint>
#include <vector>

#include "perception/crf/unary_trees.hpp"

namespace cluxel::perception {

/// Rows to learn from. A row's targets are weights, one per label: mixed cluxels have several above 0.
struct UnaryRows {
  std::uint32_t columns = 0;
  std::vector<float> features;  ///< size() x columns, row-major
  std::vector<LabelValues> targets;

  std::size_t size() const { return targets.size(); }
};

struct BoostingParams {
  int trees = 200;
  int depth = 6;  ///< splits per tree, up to kMaxTreeDepth
  double learning_rate = 0.12;
  double l2 = 10.0;           ///< added to a leaf's second derivative; rows have a mean weight of 1
  double row_share = 0.25;    ///< largest share of rows per tree; rows with large errors are preferred
  double column_share = 0.3;  ///< share of the columns that one tree may use
  int bins = 64;              ///< distinct values of a column, up to 256
  std::uint64_t seed = 1;
  std::vector<bool> columns_used = {};  ///< columns that may be used; empty: all
};

/// Gradient boosting of the multinomial log-likelihood (Friedman 2001, with second-order leaves), one tree for all
/// labels per round. Leaves are rounded to kLeafStep, so that the model file is lossless. The result does not depend on
/// the number of threads. Cost: about 4 ns x rows x columns x depth x trees x shares.
TreeEnsemble growTrees(const UnaryRows& rows, const BoostingParams& params, unsigned threads);

inline constexpr float kLeafStep = 1.0F / 4096.0F;

}  // namespace cluxel::perception
