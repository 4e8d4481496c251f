// SPDX-License-Identifier: Apache-2.0
// Pair costs as a sum of piecewise linear functions of the edge features.
#include "perception/crf/crf_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel::perception {

std::array<float, kHats> hatsAt(const HatKnots& knots, float value) {
  if (std::isnan(value)) return {0, 1, 0};
  const std::size_t left = value < knots[1] ? 0 : 1;
  const float t = std::clamp((value - knots[left]) / (knots[left + 1] - knots[left]), 0.0F, 1.0F);
  std::array<float, kHats> hats{};
  hats[left] = 1.0F - t;
  hats[left + 1] = t;
  return hats;
}

HatKnots knotsOf(std::vector<float> values) {
  std::erase_if(values, [](float value) { return !std::isfinite(value); });
  if (values.empty()) return {-1, 0, 1};
  std::sort(values.begin(), values.end());
  const auto at = [&](std::size_t percent) { return values[(values.size() - 1) * percent / 100]; };
  HatKnots knots{at(5), at(50), at(95)};
  const float gap = std::max(1e-3F, 0.05F * (values.back() - values.front()));
  knots[0] = std::min(knots[0], knots[1] - gap);
  knots[2] = std::max(knots[2], knots[1] + gap);
  return knots;
}

PairCosts pairCostsOf(const PairModel& model, std::span<const float> features, float share) {
  PairCosts costs = model.weights.front();
  for (std::size_t column = 0; column < features.size(); ++column) {
    const std::array<float, kHats> hats = hatsAt(model.knots[column], features[column]);
    for (std::size_t hat = 0; hat < kHats; ++hat) {
      if (hats[hat] == 0.0F) continue;
      const PairCosts& weights = model.weights[1 + kHats * column + hat];
      for (std::size_t pair = 0; pair < kLabelPairCount; ++pair) costs[pair] += weights[pair] * hats[hat];
    }
  }
  const float scale = model.pair_scale * (model.degree_power == 0 ? 1.0F : std::pow(share, model.degree_power));
  for (float& cost : costs) cost = std::max(cost, 0.0F) * scale;
  return costs;
}

}  // namespace cluxel::perception
