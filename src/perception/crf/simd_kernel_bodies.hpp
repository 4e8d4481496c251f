// SPDX-License-Identifier: Apache-2.0
// The bodies of the SIMD kernels, included by the two sources that compile them. They must not call inline functions of
// libraries: the linker could pick the AVX2 version of such a function for the whole program.
#pragma once

#include "perception/crf/simd_kernels.hpp"
#include "scan/truth/primitive_label.hpp"

namespace cluxel::perception {

/// Specialised for each width: GCC 12 ignores a vector size that depends on a template parameter.
template <std::size_t kWidth>
struct VectorTypes;
template <>
struct VectorTypes<4> {
  using Values = float __attribute__((vector_size(16)));
  using Marks = std::int32_t __attribute__((vector_size(16)));
};
template <>
struct VectorTypes<8> {
  using Values = float __attribute__((vector_size(32)));
  using Marks = std::int32_t __attribute__((vector_size(32)));
};

/// Unaligned load and store.
template <typename Vector>
[[gnu::always_inline]] static inline void load(const float* from, Vector& to) {
  __builtin_memcpy(&to, from, sizeof to);
}
template <typename Vector, typename Number>
[[gnu::always_inline]] static inline void store(const Vector& from, Number* to) {
  __builtin_memcpy(to, &from, sizeof from);
}

template <std::size_t kWidth>
struct TreeLanes {
  using Values = typename VectorTypes<kWidth>::Values;
  using Marks = typename VectorTypes<kWidth>::Marks;
  static_assert(sizeof(Values) == kWidth * sizeof(float) && sizeof(Marks) == sizeof(Values));
  /// The number of trees whose leaves are added at once, so that a row's sums stay in registers.
  static constexpr std::size_t kTogether = 10;
  static constexpr std::size_t kVectors = 4, kSums = kLeafRead / kWidth;
  using Places = std::int32_t[kTogether][kTreeRows];

  /// The offset of each row's leaf [floats]. Bit d of the leaf's index is the result of split d.
  [[gnu::always_inline]] static void placesOf(const TreeTable& table, std::size_t tree, const float* columns,
                                              std::int32_t* places) {
    const std::uint32_t begin = table.split_begin[tree], end = table.split_begin[tree + 1];
    for (std::size_t row = 0; row < kTreeRows; row += kVectors * kWidth) {
      Marks leaf[kVectors] = {};
      for (std::uint32_t split = end; split-- > begin;) {
        const float* values = columns + table.splits[split].column * kTreeRows + row;
        const Values threshold = Values{} + table.splits[split].threshold;
        for (std::size_t v = 0; v < kVectors; ++v) {
          Values some;
          load(values + v * kWidth, some);
          leaf[v] = leaf[v] + leaf[v] - (some > threshold);
        }
      }
      for (std::size_t v = 0; v < kVectors; ++v)
        store(leaf[v] * static_cast<std::int32_t>(scan::kPrimitiveLabelCount), places + row + v * kWidth);
    }
  }

  [[gnu::always_inline]] static void addLeaves(const TreeTable& table, std::size_t first, std::size_t count,
                                               const Places& places, float* sums) {
    const float* leaves[kTogether];
    for (std::size_t t = 0; t < count; ++t) leaves[t] = table.leaves + table.leaf_begin[first + t];
    for (std::size_t row = 0; row < kTreeRows; ++row) {
      Values total[kSums], leaf;
      for (std::size_t s = 0; s < kSums; ++s) load(sums + row * kLeafRead + s * kWidth, total[s]);
      for (std::size_t t = 0; t < count; ++t)
        for (std::size_t s = 0; s < kSums; ++s) {
          load(leaves[t] + places[t][row] + s * kWidth, leaf);
          total[s] += leaf;
        }
      for (std::size_t s = 0; s < kSums; ++s) store(total[s], sums + row * kLeafRead + s * kWidth);
    }
  }
};

template <std::size_t kWidth>
static void addTrees(const TreeTable& table, const float* columns, float* sums) {
  using Lanes = TreeLanes<kWidth>;
  typename Lanes::Places places;
  for (std::size_t first = 0; first < table.trees; first += Lanes::kTogether) {
    const std::size_t left = table.trees - first, count = left < Lanes::kTogether ? left : Lanes::kTogether;
    for (std::size_t t = 0; t < count; ++t) Lanes::placesOf(table, first + t, columns, places[t]);
    if (count == Lanes::kTogether)
      Lanes::addLeaves(table, first, Lanes::kTogether, places, sums);  // a compile-time constant
    else
      Lanes::addLeaves(table, first, count, places, sums);
  }
}

template <std::size_t kWidth>
struct PairLanes {
  using Values = typename VectorTypes<kWidth>::Values;
  static constexpr std::size_t kPairs = scan::kPrimitiveLabelCount * (scan::kPrimitiveLabelCount - 1) / 2;

  [[gnu::always_inline]] static inline Values at(const float* values, std::size_t number) {
    Values some;
    load(values + number * kPairEdges, some);
    return some;
  }

  /// Costs of kWidth edges; table values are replicated for the lanes.
  [[gnu::always_inline]] static void costsOf(const PairTable& table, const float* columns, const float* factors,
                                             float* costs) {
    const Values zero{}, one = zero + 1.0F;
    Values sum[kPairs];
    for (std::size_t pair = 0; pair < kPairs; ++pair) sum[pair] = at(table.bias, pair);
    for (std::size_t column = 0; column < table.columns; ++column) {
      const float* knots = table.knots + 4 * column * kPairEdges;
      const Values value = at(columns, column), middle = at(knots, 1);
      // Comparisons with NaN are false, so NaN counts as the middle knot.
      const auto below = value < middle;
      const Values place = (value - (below ? at(knots, 0) : middle)) / (below ? at(knots, 2) : at(knots, 3));
      const Values raised = place > zero ? place : zero, rise = raised < one ? raised : one, rest = one - rise;
      const float* weights = table.weights + 3 * kPairs * column * kPairEdges;
      for (std::size_t pair = 0; pair < kPairs; ++pair, weights += 3 * kPairEdges) {
        const Values in_middle = at(weights, 1);
        sum[pair] += (below ? at(weights, 0) : in_middle) * rest;
        sum[pair] += (below ? in_middle : at(weights, 2)) * rise;
      }
    }
    for (std::size_t pair = 0; pair < kPairs; ++pair)
      store((sum[pair] > zero ? sum[pair] : zero) * at(factors, 0), costs + pair * kPairEdges);
  }
};

template <std::size_t kWidth>
static void pairCosts(const PairTable& table, const float* columns, const float* factors, float* costs) {
  for (std::size_t lane = 0; lane < kPairEdges; lane += kWidth) {
    const auto from = [lane](const float* numbers) {
      return numbers == nullptr ? nullptr : numbers + lane;
    };  // null without columns
    PairLanes<kWidth>::costsOf({table.bias + lane, from(table.knots), from(table.weights), table.columns},
                               from(columns), factors + lane, costs + lane);
  }
}

template <std::size_t kWidth>
SimdKernels simdKernels() {
  return {addTrees<kWidth>, pairCosts<kWidth>};
}

}  // namespace cluxel::perception
