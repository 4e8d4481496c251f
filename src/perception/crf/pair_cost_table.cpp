// SPDX-License-Identifier: Apache-2.0
// The sum of pairCostsOf() in the same order of terms. Hats of 0 are added instead of skipped, which changes no bit.
#include "perception/crf/pair_cost_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "perception/crf/transposed_rows.hpp"

namespace cluxel::perception {

namespace {

/// Degrees whose powers are precomputed.
constexpr std::uint32_t kCommonDegrees = 128;

float factorFor(const PairModel& model, float share) {
  return model.pair_scale * (model.degree_power == 0 ? 1.0F : std::pow(share, model.degree_power));
}

void appendToAll(std::vector<float>& values, float value) {
  values.insert(values.end(), kPairEdges, value);
}

}  // namespace

PairCostTable::PairCostTable(const PairModel& model, const SimdKernels& kernels)
    : model_(model), kernels_(kernels), columns_(model.knots.size()), factor_(kCommonDegrees) {
  for (const float weight : model.weights.front()) appendToAll(bias_, weight);
  for (std::size_t column = 0; column < columns_; ++column) {
    const auto [low, middle, high] = model.knots[column];
    for (const float value : {low, middle, middle - low, high - middle}) appendToAll(knots_, value);
    for (std::size_t pair = 0; pair < kLabelPairCount; ++pair)
      for (std::size_t hat = 0; hat < kHats; ++hat)
        appendToAll(weights_, model.weights[1 + kHats * column + hat][pair]);
  }
  for (std::uint32_t degrees = 0; degrees < kCommonDegrees; ++degrees)
    factor_[degrees] = factorFor(model, shareOf(degrees));
}

float PairCostTable::factorOf(std::uint32_t degrees) const {
  return degrees < kCommonDegrees ? factor_[degrees] : factorFor(model_, shareOf(degrees));
}

std::vector<PairCosts> PairCostTable::costsOf(std::span<const Edge> edges) const {
  const PairTable table{bias_.data(), knots_.data(), weights_.data(), columns_};
  std::vector<PairCosts> costs(edges.size());
  std::vector<float> columns(std::max<std::size_t>(columns_, 1) * kPairEdges);  // a model may have no columns
  std::array<float, kPairEdges> factors{};
  std::array<std::array<float, kPairEdges>, kLabelPairCount> found;
  for (std::size_t begin = 0; begin < edges.size(); begin += kPairEdges) {
    const std::size_t some = std::min(kPairEdges, edges.size() - begin);
    const auto at = [&](std::size_t lane) {
      return edges[begin + std::min(lane, some - 1)];
    };  // padding repeats the last one
    for (std::size_t lane = 0; lane < kPairEdges; ++lane) factors[lane] = factorOf(at(lane).degrees);
    for (std::size_t lane = 0; lane < kPairEdges; lane += kLanes)
      transposeRows({at(lane).features, at(lane + 1).features, at(lane + 2).features, at(lane + 3).features}, columns_,
                    columns.data() + lane, kPairEdges);
    kernels_.pair_costs(table, columns.data(), factors.data(), found.front().data());
    for (std::size_t next = 0; next < kLabelPairCount; next += kLanes) {
      const std::size_t pair = std::min(next, kLabelPairCount - kLanes);  // the last vector may overlap the one before
      transposeRows({found[pair].data(), found[pair + 1].data(), found[pair + 2].data(), found[pair + 3].data()}, some,
                    costs[begin].data() + pair, kLabelPairCount);
    }
  }
  return costs;
}

}  // namespace cluxel::perception
