// SPDX-License-Identifier: Apache-2.0
// The pairwise term: the cost of different labels at the ends of an edge, from the edge's features.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "perception/crf/crf_graph.hpp"

namespace cluxel::perception {

/// Each edge feature is expanded by three hat functions (piecewise linear, summing to 1) at low, middle and high
/// values, so that a cost may rise, fall or peak along it.
inline constexpr std::size_t kHats = 3;
using HatKnots = std::array<float, kHats>;  ///< ascending, not all equal

/// V(a, b) = pair_scale * share^degree_power * max(0, weights[0][ab] + sum of weights[1 + 3 column + hat][ab] * hat).
/// `share` is 2 over the sum of the degrees at both ends: where many supports overlap, neighbours repeat the same
/// evidence, so each edge gets less weight.
struct PairModel {
  float unary_scale = 1;           ///< factor on -log of the unary's probabilities
  float pair_scale = 0;            ///< 0: no pairwise term
  float degree_power = 0;          ///< 0: all edges have equal weight; 1: the edges of a node sum to one edge
  std::vector<HatKnots> knots;     ///< one per edge column
  std::vector<PairCosts> weights;  ///< 1 + kHats * columns
};

/// The values of the hat functions at `value`; NaN counts as the middle knot.
std::array<float, kHats> hatsAt(const HatKnots& knots, float value);

/// Knots at the 5th, 50th and 95th percentile of the values, spread where these coincide.
HatKnots knotsOf(std::vector<float> values);

/// Costs of the pairs of labels at one edge. `features` has one value per knots entry. The reference implementation:
/// PairCostTable gives the same bits for many edges.
PairCosts pairCostsOf(const PairModel& model, std::span<const float> features, float share);

}  // namespace cluxel::perception
