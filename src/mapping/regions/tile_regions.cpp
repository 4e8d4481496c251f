// SPDX-License-Identifier: Apache-2.0
// Halves are cut at the middle tile, whatever the tiles hold.
#include "mapping/regions/tile_regions.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace cluxel::mapping {

namespace {

using perception::TileSet;
using TileIterator = std::vector<CountedTile>::iterator;

void addRegions(TileIterator first, TileIterator last, std::size_t max_cluxels, std::vector<TileSet>& regions) {
  std::size_t cluxels = 0;
  Eigen::AlignedBox2i box;
  for (auto tile = first; tile != last; ++tile) {
    cluxels += tile->cluxels;
    box.extend(Eigen::Vector2i(tile->key.x, tile->key.y));
  }
  if (last - first <= 1 || cluxels <= max_cluxels) {
    TileSet& region = regions.emplace_back();
    for (auto tile = first; tile != last; ++tile) region.insert(tile->key);
    return;
  }
  const bool along_x = box.sizes().x() >= box.sizes().y();
  const auto order = [along_x](const CountedTile& a, const CountedTile& b) {
    return along_x ? a.key < b.key : std::pair(a.key.y, a.key.x) < std::pair(b.key.y, b.key.x);
  };
  std::sort(first, last, order);
  const auto middle = first + (last - first) / 2;
  addRegions(first, middle, max_cluxels, regions);
  addRegions(middle, last, max_cluxels, regions);
}

}  // namespace

std::vector<TileSet> regionsOf(std::vector<CountedTile> tiles, std::size_t max_cluxels) {
  std::vector<TileSet> regions;
  if (!tiles.empty()) addRegions(tiles.begin(), tiles.end(), max_cluxels, regions);
  return regions;
}

}  // namespace cluxel::mapping
