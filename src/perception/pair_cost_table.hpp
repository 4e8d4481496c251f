// SPDX-License-Identifier: Apache-2.0
// Pair costs of many edges under one model: the weights laid out for vectors, nothing decided by a branch.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cluxel/perception/crf_pairs.hpp"
#include "perception/vector_lanes.hpp"

namespace cluxel {

/// Gives the same bits as pairCostsOf(), some ten times as fast.
class PairCostTable {
 public:
  explicit PairCostTable(const PairModel& model);

  std::size_t columns() const { return x_count; }
  /// `features` holds columns() values; `degrees` is the sum of the degrees at both ends, and the edge's share is 2 over it.
  PairCosts at(const float* features, std::uint32_t degrees) const;

 private:
  static constexpr std::size_t kVectors = (kLabelPairCount + kLanes - 1) / kLanes;
  static constexpr std::size_t kMostColumns = 32;
  /// Weights of the pairs, padded with zeros.
  using Costs = std::array<Floats, kVectors>;
  /// Where the values of an edge lie between the knots: the place of the left of two hats, and the height of the right one.
  struct Places {
    std::array<std::int32_t, kMostColumns> right_half;   ///< -1: between the middle and the last knot
    std::array<float, kMostColumns> rise;
  };

  [[gnu::always_inline]] inline void placeFour(const float* features, std::size_t column, Places& places) const;
  float factorOf(std::uint32_t degrees) const;

  PairModel x_model;
  std::size_t x_count;
  std::vector<float> x_low, x_middle, x_low_width, x_high_width;   ///< of the knots, by column
  std::vector<Costs> x_weights;        ///< as the model has them: the bias, then kHats for each column
  std::vector<float> x_factor;   ///< by degrees
};

/// 2 over the degrees at both ends of an edge.
inline float shareOf(std::uint32_t degrees) { return 2.0F / static_cast<float>(degrees < 2 ? 2 : degrees); }

}  // namespace cluxel
