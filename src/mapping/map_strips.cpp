// SPDX-License-Identifier: Apache-2.0
// Tiles are sorted along the longer side, and a strip ends when it has its share of the weight.
#include "mapping/map_strips.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

std::vector<TileKey> alongTheLongerSide(const TileSet& tiles) {
  std::vector<TileKey> sorted(tiles.begin(), tiles.end());
  const auto [west, east] = std::minmax_element(sorted.begin(), sorted.end(), [](auto a, auto b) { return a.x < b.x; });
  const auto [south, north] =
      std::minmax_element(sorted.begin(), sorted.end(), [](auto a, auto b) { return a.y < b.y; });
  if (!sorted.empty() && north->y - south->y > east->x - west->x)
    std::sort(sorted.begin(), sorted.end(), [](auto a, auto b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); });
  return sorted;
}

}  // namespace

std::vector<TileSet> stripsOf(const TileSet& tiles, std::size_t count,
                              const std::function<std::uint64_t(const TileKey&)>& weight_of) {
  std::map<TileKey, std::uint64_t> weights;
  std::uint64_t all = 0;
  for (const TileKey& tile : tiles) all += weights[tile] = weight_of(tile);
  std::vector<TileSet> strips(1);
  std::uint64_t of_strip = 0;
  for (const TileKey& tile : alongTheLongerSide(tiles)) {
    if (of_strip > 0 && of_strip * count >= all) strips.emplace_back(), of_strip = 0;
    strips.back().insert(tile);
    of_strip += weights.at(tile);
  }
  return strips;
}

}  // namespace cluxel::mapping
