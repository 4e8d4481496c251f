// SPDX-License-Identifier: Apache-2.0
// Features cut into a few bins per column, so that split search counts instead of sorting.
#pragma once

#include <cstdint>
#include <vector>

#include "cluxel/perception/unary_training.hpp"

namespace cluxel {

class FeatureBins {
 public:
  /// Cuts each used column at equal sums of target weight.
  FeatureBins(const UnaryRows& rows, const BoostingParams& params, unsigned threads);

  std::size_t columns() const { return x_cuts.size(); }
  /// Ascending; a value lies in the bin whose number is how many cuts it exceeds.
  const std::vector<float>& cuts(std::size_t column) const { return x_cuts[column]; }
  const std::uint8_t* bins(std::size_t column) const { return x_bins.data() + column * x_rows; }

 private:
  std::size_t x_rows;
  std::vector<std::vector<float>> x_cuts;
  std::vector<std::uint8_t> x_bins;  // column by column
};

}  // namespace cluxel
