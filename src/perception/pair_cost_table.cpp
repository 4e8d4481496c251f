// SPDX-License-Identifier: Apache-2.0
// The sum of pairCostsOf(), term by term in its order; a hat of 0 adds nothing here where it is left out there.
#include "perception/pair_cost_table.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel {

namespace {

/// Degrees whose powers are kept at hand.
constexpr std::uint32_t kCommonDegrees = 128;

float factorFor(const PairModel& model, float share) {
  return model.pair_scale * (model.degree_power == 0 ? 1.0F : std::pow(share, model.degree_power));
}

}  // namespace

PairCostTable::PairCostTable(const PairModel& model) : x_model(model), x_count(model.knots.size()), x_factor(kCommonDegrees) {
  for (const HatKnots& knots : model.knots) {
    x_low.push_back(knots[0]);
    x_middle.push_back(knots[1]);
    x_low_width.push_back(knots[1] - knots[0]);
    x_high_width.push_back(knots[2] - knots[1]);
  }
  for (const PairCosts& row : model.weights) {
    std::array<float, kVectors * kLanes> padded{};
    std::copy(row.begin(), row.end(), padded.begin());
    Costs& costs = x_weights.emplace_back();
    for (std::size_t v = 0; v < kVectors; ++v) costs[v] = loadFloats(padded.data() + v * kLanes);
  }
  for (std::uint32_t degrees = 0; degrees < kCommonDegrees; ++degrees) x_factor[degrees] = factorFor(model, shareOf(degrees));
}

float PairCostTable::factorOf(std::uint32_t degrees) const {
  return degrees < kCommonDegrees ? x_factor[degrees] : factorFor(x_model, shareOf(degrees));
}

inline void PairCostTable::placeFour(const float* features, std::size_t column, Places& places) const {
  const Floats value = loadFloats(features + column), middle = loadFloats(x_middle.data() + column);
  // A value that is not a number lies below nothing, and rises nowhere: it counts as the middle.
  const Numbers below = value < middle;
  const Floats from = below ? loadFloats(x_low.data() + column) : middle;
  const Floats width = below ? loadFloats(x_low_width.data() + column) : loadFloats(x_high_width.data() + column);
  const Floats place = (value - from) / width, zero{}, one = zero + 1.0F;
  const Floats raised = place > zero ? place : zero;
  storeFloats(raised < one ? raised : one, places.rise.data() + column);
  const Numbers above = ~below;
  std::memcpy(places.right_half.data() + column, &above, sizeof above);
}

PairCosts PairCostTable::at(const float* features, std::uint32_t degrees) const {
  if (x_count < kLanes || x_count > kMostColumns) return pairCostsOf(x_model, {features, x_count}, shareOf(degrees));
  Places places;
  for (std::size_t column = 0; column + kLanes <= x_count; column += kLanes) placeFour(features, column, places);
  if (x_count % kLanes != 0) placeFour(features, x_count - kLanes, places);   // some of them once more
  Costs sum = x_weights.front();
  for (std::size_t column = 0; column < x_count; ++column) {
    const Costs* left = x_weights.data() + 1 + kHats * column - places.right_half[column];
    const float rise = places.rise[column], rest = 1.0F - rise;
    for (std::size_t v = 0; v < kVectors; ++v) {
      sum[v] += left[0][v] * rest;
      sum[v] += left[1][v] * rise;
    }
  }
  const float factor = factorOf(degrees);
  std::array<float, kVectors * kLanes> costs;
  for (std::size_t v = 0; v < kVectors; ++v) {
    const Floats zero{};
    storeFloats((sum[v] > zero ? sum[v] : zero) * factor, costs.data() + v * kLanes);
  }
  PairCosts result;
  std::copy_n(costs.begin(), result.size(), result.begin());
  return result;
}

}  // namespace cluxel
