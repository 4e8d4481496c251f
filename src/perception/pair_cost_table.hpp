// SPDX-License-Identifier: Apache-2.0
// Pair costs of many edges under one model: the weights laid out for vectors of edges, nothing decided by a branch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cluxel/perception/crf_pairs.hpp"
#include "perception/lane_kernels.hpp"

namespace cluxel {

/// Gives the same bits as pairCostsOf(), many times as fast.
class PairCostTable {
 public:
  explicit PairCostTable(const PairModel& model, const LaneKernels& kernels = fastestKernels());

  struct Edge {
    const float* features;  ///< columns() values
    std::uint32_t degrees;  ///< at both ends together: the edge's share is 2 over it
  };
  std::size_t columns() const { return x_columns; }
  std::vector<PairCosts> costsOf(std::span<const Edge> edges) const;

 private:
  float factorOf(std::uint32_t degrees) const;

  PairModel x_model;
  LaneKernels x_kernels;
  std::size_t x_columns;
  std::vector<float> x_bias, x_knots, x_weights;  ///< as PairTable has them
  std::vector<float> x_factor;                    ///< by degrees
};

/// 2 over the degrees at both ends of an edge.
inline float shareOf(std::uint32_t degrees) {
  return 2.0F / static_cast<float>(degrees < 2 ? 2 : degrees);
}

}  // namespace cluxel
