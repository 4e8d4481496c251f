// SPDX-License-Identifier: Apache-2.0
// What is computed for many rows alike, for vectors of several widths: one template each, compiled once for any machine
// (four lanes) and once for those with AVX2 (eight). Both give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cluxel {

/// Rows scored together by the trees: their columns fit into the nearest cache.
inline constexpr std::size_t kTreeRows = 64;
/// Floats of a row's sums, and how many may be read from the beginning of a leaf: labels, and some of no use.
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

/// Edges whose pair costs are worked out together.
inline constexpr std::size_t kPairEdges = 8;

/// A pair model; each number stands kPairEdges times.
struct PairTable {
  const float* bias;     ///< per pair of labels
  const float* knots;    ///< per column: low, middle, width below the middle, width above
  const float* weights;  ///< per column and pair: of the hats at the low, the middle and the high knot
  std::size_t columns;
};

struct LaneKernels {
  /// Adds the leaves of all trees, tree by tree, to the sums of kTreeRows rows (kLeafRead floats each). `columns` holds
  /// kTreeRows values of each column.
  void (*add_trees)(const TreeTable& table, const float* columns, float* sums);
  /// Fills kPairEdges costs per pair of labels, from kPairEdges values of each column and as many factors.
  void (*pair_costs)(const PairTable& table, const float* columns, const float* factors, float* costs);
};

/// For 4 lanes, on any machine, and for 8, where hasEightLanes().
template <std::size_t kWidth>
LaneKernels laneKernels();
extern template LaneKernels laneKernels<4>();
extern template LaneKernels laneKernels<8>();

bool hasEightLanes();
/// The fastest that this machine can run.
inline LaneKernels fastestKernels() {
  return hasEightLanes() ? laneKernels<8>() : laneKernels<4>();
}

}  // namespace cluxel
