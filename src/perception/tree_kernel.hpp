// SPDX-License-Identifier: Apache-2.0
// Trees over a block of rows, for vectors of several widths: one template, compiled once for any machine (four lanes) and
// once for those with AVX2 (eight). Both give the same bits. Nothing of a library may be called here: the linker would be
// free to take its AVX2 version for all.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cluxel {

/// Rows scored together: their columns fit into the nearest cache.
inline constexpr std::size_t kTreeRows = 64;
/// Floats of a row's sums, and how many may be read from the beginning of a leaf: labels, and some of no use.
inline constexpr std::size_t kLeafRead = 8;

struct TreeTable {
  struct Split {
    std::uint32_t column;
    float threshold;
  };
  const Split* splits;                 ///< tree by tree
  const std::uint32_t* split_begin;    ///< trees + 1
  const float* leaves;                 ///< tree by tree, kPrimitiveLabelCount each
  const std::uint32_t* leaf_begin;     ///< per tree, in floats
  std::size_t trees;
};

/// Adds the leaves of all trees, tree by tree, to the sums of kTreeRows rows (kLeafRead floats each). `columns` holds
/// kTreeRows values of each column.
using TreeKernel = void(const TreeTable& table, const float* columns, float* sums);
template <std::size_t kWidth>
TreeKernel addTrees;
extern template TreeKernel addTrees<4>;
extern template TreeKernel addTrees<8>;

/// The fastest one that this machine can run.
TreeKernel* fastestTreeKernel();
bool hasEightLanes();

}  // namespace cluxel
