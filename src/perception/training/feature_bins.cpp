// SPDX-License-Identifier: Apache-2.0
// Cut points at weighted quantiles of a column.
#include "perception/training/feature_bins.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.hpp"

namespace cluxel::perception {

namespace {

float weightOf(const LabelValues& targets) {
  float sum = 0;
  for (const float target : targets) sum += target;
  return sum;
}

/// Values of one column with their weights, ascending; at most some 60 thousand rows at an even stride.
std::vector<std::pair<float, float>> sortedColumn(const UnaryRows& rows, std::size_t column) {
  const std::size_t stride = rows.size() / 60000 + 1;
  std::vector<std::pair<float, float>> values;
  for (std::size_t r = 0; r < rows.size(); r += stride) {
    const float value = rows.features[r * rows.columns + column];
    if (std::isfinite(value)) values.emplace_back(value, weightOf(rows.targets[r]));
  }
  std::sort(values.begin(), values.end());
  return values;
}

std::vector<float> cutsOf(const std::vector<std::pair<float, float>>& values, int bins) {
  double total = 0, passed = 0;
  for (const auto& [value, weight] : values) total += static_cast<double>(weight);
  std::vector<float> cuts;
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    passed += static_cast<double>(values[i].second);
    const double due = total * static_cast<double>(cuts.size() + 1) / bins;
    if (passed < due || values[i].first == values[i + 1].first) continue;
    const float middle = values[i].first + 0.5F * (values[i + 1].first - values[i].first);
    cuts.push_back(middle < values[i + 1].first ? middle : values[i].first);
    if (cuts.size() + 1 == static_cast<std::size_t>(bins)) break;
  }
  return cuts;
}

}  // namespace

FeatureBins::FeatureBins(const UnaryRows& rows, const BoostingParams& params, unsigned threads)
    : rows_(rows.size()), cuts_(rows.columns), bins_(rows.size() * rows.columns) {
  parallelFor(rows.columns, threads, [&](std::size_t column) {
    if (!params.columns_used.empty() && !params.columns_used[column]) return;
    cuts_[column] = cutsOf(sortedColumn(rows, column), params.bins);
    const std::vector<float>& cuts = cuts_[column];
    for (std::size_t r = 0; r < rows_; ++r) {
      const float value = rows.features[r * rows.columns + column];
      // NaN exceeds no cut, as in scoring.
      const auto above = value == value ? std::lower_bound(cuts.begin(), cuts.end(), value) - cuts.begin() : 0;
      bins_[column * rows_ + r] = static_cast<std::uint8_t>(above);
    }
  });
}

}  // namespace cluxel::perception
