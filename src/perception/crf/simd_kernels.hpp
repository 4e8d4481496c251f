// SPDX-License-Identifier: Apache-2.0
// SIMD kernels over many rows: one template each, compiled once for any machine (4 lanes) and once for AVX2 (8 lanes).
// Both give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cluxel::perception {

/// Rows scored together by the trees; their columns fit into the L1 cache.
inline constexpr std::size_t kTreeRows = 64;
/// Floats per row of sums, and floats read per leaf: the labels plus padding.
inline constexpr std::size_t kLeafRead = 8;

/// An ensemble of oblivious trees.
struct TreeTable {
  struct Split {
    std::uint32_t column;
    float threshold;
  };
  const Split* splits;               ///< tree by tree
  const std::uint32_t* split_begin;  ///< trees + 1
  const float* leaves;               ///< tree by tree, kPrimitiveLabelCount each
  const std::uint32_t* leaf_begin;   ///< per tree, in floats
  std::size_t trees;
};

/// Edges whose pair costs are computed together.
inline constexpr std::size_t kPairEdges = 8;

/// A pair model; each number is replicated kPairEdges times.
struct PairTable {
  const float* bias;     ///< per pair of labels
  const float* knots;    ///< per column: low, middle, width below the middle, width above
  const float* weights;  ///< per column and pair: of the hats at the low, the middle and the high knot
  std::size_t columns;
};

struct SimdKernels {
  /// Adds the leaves of all trees, tree by tree, to the sums of kTreeRows rows (kLeafRead floats each). `columns` holds
  /// kTreeRows values of each column.
  void (*add_trees)(const TreeTable& table, const float* columns, float* sums);
  /// Computes kPairEdges costs per pair of labels, from kPairEdges values of each column and kPairEdges factors.
  void (*pair_costs)(const PairTable& table, const float* columns, const float* factors, float* costs);
};

/// The kernels for 4 lanes (any machine) or 8 lanes (only if hasEightLanes()).
template <std::size_t kWidth>
SimdKernels simdKernels();
extern template SimdKernels simdKernels<4>();
extern template SimdKernels simdKernels<8>();

bool hasEightLanes();
/// The fastest kernels that this machine can run.
inline SimdKernels fastestKernels() {
  return hasEightLanes() ? simdKernels<8>() : simdKernels<4>();
}

}  // namespace cluxel::perception
