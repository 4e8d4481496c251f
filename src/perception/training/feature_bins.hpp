// SPDX-License-Identifier: Apache-2.0
// Features quantised into a few bins per column, so that the search for splits needs histograms instead of sorting.
#pragma once

#include <cstdint>
#include <vector>

#include "perception/training/unary_training.hpp"

namespace cluxel::perception {

class FeatureBins {
 public:
  /// Cuts each used column at equal sums of target weight.
  FeatureBins(const UnaryRows& rows, const BoostingParams& params, unsigned threads);

  std::size_t columns() const { return cuts_.size(); }
  /// Ascending; a value lies in the bin whose number is how many cuts it exceeds.
  const std::vector<float>& cuts(std::size_t column) const { return cuts_[column]; }
  const std::uint8_t* bins(std::size_t column) const { return bins_.data() + column * rows_; }

 private:
  std::size_t rows_;
  std::vector<std::vector<float>> cuts_;
  std::vector<std::uint8_t> bins_;  // column by column
};

}  // namespace cluxel::perception
