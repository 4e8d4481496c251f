// SPDX-License-Identifier: Apache-2.0
// The nearest values on both sides of each threshold.
#include "rules/decide/threshold_margins.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cluxel::rules {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

void ThresholdMargin::narrow(const ThresholdMargin& other) {
  below = std::max(below, other.below);
  above = std::min(above, other.above);
}

std::vector<double> quotientsToNote(double value, double other, double ratio) {
  if (other == 0) return {};
  const double quotient = value / other, rounding = 4 * std::numeric_limits<double>::epsilon() * std::abs(quotient);
  if (quotient - rounding > ratio) return {quotient - rounding};
  if (quotient + rounding < ratio) return {quotient + rounding};
  return {std::nextafter(ratio, -kInfinity), ratio};
}

ThresholdMargins::ThresholdMargins(const perception::Scene& scene, const RuleSet& rules)
    : thresholds_(rules.thresholds),
      count_(rules.thresholds.size()),
      constants_(rules.constants.size()),
      words_((constants_ + kBits - 1) / kBits) {
  std::vector<perception::TileKey> first;
  for (const perception::Primitive& primitive : scene.primitives)
    first.push_back(scene.cluxels.name[primitive.cluxels.front()].tile);
  tiles_ = first;
  std::sort(tiles_.begin(), tiles_.end());
  tiles_.erase(std::unique(tiles_.begin(), tiles_.end()), tiles_.end());
  for (const perception::TileKey& tile : first)
    tile_of_.push_back(
        static_cast<std::uint32_t>(std::lower_bound(tiles_.begin(), tiles_.end(), tile) - tiles_.begin()));
  const std::size_t size = tiles_.size() * count_;
  for (auto& [bounds, start] : {std::pair(&below_, -kInfinity), std::pair(&above_, kInfinity)}) {
    *bounds = std::make_unique<std::atomic<double>[]>(size);
    for (std::size_t i = 0; i < size; ++i) (*bounds)[i].store(start, std::memory_order_relaxed);
  }
  used_ = std::make_unique<std::atomic<std::uint64_t>[]>(tiles_.size() * words_);
}

void ThresholdMargins::noteFixed(perception::PrimitiveIndex primitive, std::uint32_t threshold) {
  const PlainThreshold& used = thresholds_[threshold - 1];
  const std::size_t place = tile_of_[primitive] * count_ + threshold - 1;
  raise(below_[place], used.is_met_by_equal ? std::nextafter(used.value, -kInfinity) : used.value);
  lower(above_[place], used.is_met_by_equal ? used.value : std::nextafter(used.value, kInfinity));
}

TileMargins ThresholdMargins::found() const {
  TileMargins margins;
  for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
    TileMargin margin;
    for (std::size_t i = 0; i < count_; ++i) {
      const double below = below_[tile * count_ + i], above = above_[tile * count_ + i];
      if (below > -kInfinity || above < kInfinity)
        margin.thresholds.push_back({static_cast<std::uint32_t>(i + 1), below, above});
    }
    for (std::size_t i = 0; i < constants_; ++i)
      if ((used_[tile * words_ + i / kBits] >> i % kBits & 1U) != 0)
        margin.constants.push_back(static_cast<std::uint32_t>(i + 1));
    if (margin != TileMargin{}) margins.emplace(tiles_[tile], std::move(margin));
  }
  return margins;
}

perception::TileSet tilesBeyond(const TileMargins& margins, const std::vector<std::uint64_t>& constants,
                                const RuleSet& rules) {
  perception::TileSet tiles;
  for (const auto& [tile, margin] : margins)
    if (!std::all_of(margin.thresholds.begin(), margin.thresholds.end(),
                     [&](const ThresholdMargin& of) { return of.allows(rules.thresholds[of.threshold - 1]); }) ||
        !std::all_of(margin.constants.begin(), margin.constants.end(),
                     [&](std::uint32_t number) { return constants[number - 1] == rules.constants[number - 1]; }))
      tiles.insert(tile);
  return tiles;
}

}  // namespace cluxel::rules
