// SPDX-License-Identifier: Apache-2.0
// The sum of pairCostsOf(), term by term in its order; a hat of 0 adds nothing here where it is left out there.
#include "perception/pair_cost_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "perception/turned_rows.hpp"

namespace cluxel {

namespace {

/// Degrees whose powers are kept at hand.
constexpr std::uint32_t kCommonDegrees = 128;

float factorFor(const PairModel& model, float share) {
  return model.pair_scale * (model.degree_power == 0 ? 1.0F : std::pow(share, model.degree_power));
}

void appendToAll(std::vector<float>& values, float value) {
  values.insert(values.end(), kPairEdges, value);
}

}  // namespace

PairCostTable::PairCostTable(const PairModel& model, const LaneKernels& kernels)
    : x_model(model), x_kernels(kernels), x_columns(model.knots.size()), x_factor(kCommonDegrees) {
  for (const float weight : model.weights.front()) appendToAll(x_bias, weight);
  for (std::size_t column = 0; column < x_columns; ++column) {
    const auto [low, middle, high] = model.knots[column];
    for (const float value : {low, middle, middle - low, high - middle}) appendToAll(x_knots, value);
    for (std::size_t pair = 0; pair < kLabelPairCount; ++pair)
      for (std::size_t hat = 0; hat < kHats; ++hat)
        appendToAll(x_weights, model.weights[1 + kHats * column + hat][pair]);
  }
  for (std::uint32_t degrees = 0; degrees < kCommonDegrees; ++degrees)
    x_factor[degrees] = factorFor(model, shareOf(degrees));
}

float PairCostTable::factorOf(std::uint32_t degrees) const {
  return degrees < kCommonDegrees ? x_factor[degrees] : factorFor(x_model, shareOf(degrees));
}

std::vector<PairCosts> PairCostTable::costsOf(std::span<const Edge> edges) const {
  const PairTable table{x_bias.data(), x_knots.data(), x_weights.data(), x_columns};
  std::vector<PairCosts> costs(edges.size());
  std::vector<float> columns(x_columns * kPairEdges);
  std::array<float, kPairEdges> factors{};
  std::array<std::array<float, kPairEdges>, kLabelPairCount> found;
  for (std::size_t begin = 0; begin < edges.size(); begin += kPairEdges) {
    const std::size_t some = std::min(kPairEdges, edges.size() - begin);
    constexpr std::size_t kAhead = 3 * kPairEdges;
    for (std::size_t i = begin + kAhead; i < std::min(begin + kAhead + kPairEdges, edges.size()); ++i)
      __builtin_prefetch(edges[i].features);
    const auto at = [&](std::size_t lane) { return edges[begin + std::min(lane, some - 1)]; };  // the last one fills up
    for (std::size_t lane = 0; lane < kPairEdges; ++lane) factors[lane] = factorOf(at(lane).degrees);
    for (std::size_t lane = 0; lane < kPairEdges; lane += kLanes)
      turnRows({at(lane).features, at(lane + 1).features, at(lane + 2).features, at(lane + 3).features}, x_columns,
               columns.data() + lane, kPairEdges);
    x_kernels.pair_costs(table, columns.data(), factors.data(), found.front().data());
    for (std::size_t next = 0; next < kLabelPairCount; next += kLanes) {
      const std::size_t pair = std::min(next, kLabelPairCount - kLanes);  // the last ones may be written twice
      turnRows({found[pair].data(), found[pair + 1].data(), found[pair + 2].data(), found[pair + 3].data()}, some,
               costs[begin].data() + pair, kLabelPairCount);
    }
  }
  return costs;
}

}  // namespace cluxel
