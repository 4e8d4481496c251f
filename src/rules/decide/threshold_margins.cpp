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

ThresholdMargins::ThresholdMargins(const perception::Scene& scene, const RuleSet& rules)
    : thresholds_(rules.thresholds), count_(rules.thresholds.size()) {
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
}

void ThresholdMargins::noteUse(perception::PrimitiveIndex primitive, std::uint32_t threshold) {
  const PlainThreshold& used = thresholds_[threshold - 1];
  const std::size_t place = tile_of_[primitive] * count_ + threshold - 1;
  const bool opens_below = !used.is_hash && used.is_met_by_equal, opens_above = !used.is_hash && !used.is_met_by_equal;
  raise(below_[place], opens_below ? std::nextafter(used.value, -kInfinity) : used.value);
  lower(above_[place], opens_above ? std::nextafter(used.value, kInfinity) : used.value);
}

TileMargins ThresholdMargins::found() const {
  TileMargins margins;
  for (std::size_t tile = 0; tile < tiles_.size(); ++tile)
    for (std::size_t i = 0; i < count_; ++i) {
      const double below = below_[tile * count_ + i], above = above_[tile * count_ + i];
      if (below > -kInfinity || above < kInfinity)
        margins[tiles_[tile]].push_back({static_cast<std::uint32_t>(i + 1), below, above});
    }
  return margins;
}

perception::TileSet tilesBeyond(const TileMargins& margins, const RuleSet& rules) {
  perception::TileSet tiles;
  for (const auto& [tile, of_tile] : margins)
    if (std::any_of(of_tile.begin(), of_tile.end(), [&](const ThresholdMargin& margin) {
          return !margin.allows(rules.thresholds[margin.threshold - 1]);
        }))
      tiles.insert(tile);
  return tiles;
}

}  // namespace cluxel::rules
