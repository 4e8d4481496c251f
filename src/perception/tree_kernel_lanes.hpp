// SPDX-License-Identifier: Apache-2.0
// The body of the tree kernel; included by the two sources that compile it.
#pragma once

#include "cluxel/scan/primitive_label.hpp"
#include "perception/tree_kernel.hpp"

namespace cluxel {

/// Vectors at any address. Written out for each width: a size that depends on a parameter is lost on GCC 12.
template <std::size_t kWidth>
struct VectorTypes;
template <>
struct VectorTypes<4> {
  using Values = float __attribute__((vector_size(16), aligned(4), may_alias));
  using Marks = std::int32_t __attribute__((vector_size(16), aligned(4), may_alias));
};
template <>
struct VectorTypes<8> {
  using Values = float __attribute__((vector_size(32), aligned(4), may_alias));
  using Marks = std::int32_t __attribute__((vector_size(32), aligned(4), may_alias));
};

template <std::size_t kWidth>
struct TreeLanes {
  using Values = typename VectorTypes<kWidth>::Values;
  using Marks = typename VectorTypes<kWidth>::Marks;
  static_assert(sizeof(Values) == kWidth * sizeof(float) && sizeof(Marks) == sizeof(Values));
  /// Trees whose leaves are added in one go, so that a row's sums stay in registers.
  static constexpr std::size_t kTogether = 10;
  static constexpr std::size_t kVectors = 4, kSums = kLeafRead / kWidth;
  using Places = std::int32_t[kTogether][kTreeRows];

  /// Where the leaf of each row begins, in floats: its number has the bits of the splits from the last to the first.
  [[gnu::always_inline]] static void placesOf(const TreeTable& table, std::size_t tree, const float* columns, std::int32_t* places) {
    const std::uint32_t begin = table.split_begin[tree], end = table.split_begin[tree + 1];
    for (std::size_t row = 0; row < kTreeRows; row += kVectors * kWidth) {
      Marks leaf[kVectors] = {};
      for (std::uint32_t split = end; split-- > begin;) {
        const float* values = columns + table.splits[split].column * kTreeRows + row;
        const Values threshold = Values{} + table.splits[split].threshold;
        for (std::size_t v = 0; v < kVectors; ++v)
          leaf[v] = leaf[v] + leaf[v] - (*reinterpret_cast<const Values*>(values + v * kWidth) > threshold);
      }
      for (std::size_t v = 0; v < kVectors; ++v)
        *reinterpret_cast<Marks*>(places + row + v * kWidth) = leaf[v] * static_cast<std::int32_t>(kPrimitiveLabelCount);
    }
  }

  [[gnu::always_inline]] static void addLeaves(const TreeTable& table, std::size_t first, std::size_t count, const Places& places,
                                               float* sums) {
    const float* leaves[kTogether];
    for (std::size_t t = 0; t < count; ++t) leaves[t] = table.leaves + table.leaf_begin[first + t];
    for (std::size_t row = 0; row < kTreeRows; ++row) {
      auto* sum = reinterpret_cast<Values*>(sums + row * kLeafRead);
      Values total[kSums];
      for (std::size_t s = 0; s < kSums; ++s) total[s] = sum[s];
      for (std::size_t t = 0; t < count; ++t) {
        const auto* leaf = reinterpret_cast<const Values*>(leaves[t] + places[t][row]);
        for (std::size_t s = 0; s < kSums; ++s) total[s] += leaf[s];
      }
      for (std::size_t s = 0; s < kSums; ++s) sum[s] = total[s];
    }
  }
};

template <std::size_t kWidth>
void addTrees(const TreeTable& table, const float* columns, float* sums) {
  using Lanes = TreeLanes<kWidth>;
  typename Lanes::Places places;
  for (std::size_t first = 0; first < table.trees; first += Lanes::kTogether) {
    const std::size_t left = table.trees - first, count = left < Lanes::kTogether ? left : Lanes::kTogether;
    for (std::size_t t = 0; t < count; ++t) Lanes::placesOf(table, first + t, columns, places[t]);
    if (count == Lanes::kTogether)
      Lanes::addLeaves(table, first, Lanes::kTogether, places, sums);   // a number that the compiler knows
    else
      Lanes::addLeaves(table, first, count, places, sums);
  }
}

}  // namespace cluxel
