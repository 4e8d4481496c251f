// SPDX-License-Identifier: Apache-2.0
// A pairwise conditional random field over cluxels: unary costs of labels and pairwise costs of different labels.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "scan/truth/primitive_label.hpp"

namespace cluxel::perception {

/// The cost of each primitive label at one cluxel, as -log of its probability.
using LabelCosts = std::array<float, scan::kPrimitiveLabelCount>;

/// Unordered pairs of different labels.
inline constexpr std::size_t kLabelPairCount = scan::kPrimitiveLabelCount * (scan::kPrimitiveLabelCount - 1) / 2;
/// The cost of each pair of different labels at the ends of one edge, at least 0. Equal labels cost nothing.
using PairCosts = std::array<float, kLabelPairCount>;

/// The index of labels `a` != `b` in PairCosts, in the order 01 02 03 04 12 13 14 23 24 34; symmetric.
constexpr std::size_t labelPair(std::size_t a, std::size_t b) {
  const std::size_t low = std::min(a, b), high = std::max(a, b);
  return low * (2 * scan::kPrimitiveLabelCount - low - 1) / 2 + (high - low - 1);
}

static_assert(labelPair(0, 1) == 0 && labelPair(4, 3) == kLabelPairCount - 1 && labelPair(2, 1) == 4);

struct CrfEdge {
  std::uint32_t from = 0, to = 0;  ///< from < to
  auto operator<=>(const CrfEdge&) const = default;
};

/// E(y) = sum of unary[i][y_i] over nodes + sum of pair_costs[e][y_from, y_to] over edges.
struct CrfGraph {
  std::vector<LabelCosts> unary;
  std::vector<CrfEdge> edges;         ///< ascending, each once
  std::vector<PairCosts> pair_costs;  ///< one per edge

  std::size_t size() const { return unary.size(); }
};

}  // namespace cluxel::perception
