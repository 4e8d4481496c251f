// SPDX-License-Identifier: Apache-2.0
// The pairwise term: what a difference of labels costs across an edge, from the edge's features.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "cluxel/perception/crf_graph.hpp"

namespace cluxel {

/// Each edge feature is seen through three hats (piecewise linear bumps that sum to 1) at low, middle and high values,
/// so that a cost may rise, fall or peak along it.
inline constexpr std::size_t kHats = 3;
using HatKnots = std::array<float, kHats>;  ///< ascending, not all equal

/// V(a, b) = pair_scale * share^degree_power * max(0, weights[0][ab] + sum of weights[1 + 3 column + hat][ab] * hat).
/// `share` is 2 over the sum of the degrees at both ends: where many supports overlap, the neighbours repeat one
/// another's evidence, and each counts less.
struct PairModel {
  float unary_scale = 1;           ///< factor on -log of the unary's probabilities
  float pair_scale = 0;            ///< 0: no pairwise term
  float degree_power = 0;          ///< 0: edges count alike; 1: a node's edges count together as one
  std::vector<HatKnots> knots;     ///< one per edge column
  std::vector<PairCosts> weights;  ///< 1 + kHats * columns
};

/// The values of the hats at `value`; NaN counts as the middle.
std::array<float, kHats> hatsAt(const HatKnots& knots, float value);

/// Knots at the 5th, 50th and 95th of a hundred of the values, pulled apart where these coincide.
HatKnots knotsOf(std::vector<float> values);

/// Costs of the pairs of labels at one edge. `features` has one value per knots entry. The formula as it stands;
/// PairCostTable gives the same bits for many edges.
PairCosts pairCostsOf(const PairModel& model, std::span<const float> features, float share);

}  // namespace cluxel
