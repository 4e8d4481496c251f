// SPDX-License-Identifier: Apache-2.0
// Orders tiles by row, and finds those that a stage may compute.
#include "perception/point_bands.hpp"

#include <algorithm>

namespace cluxel::perception {

Axis longerAxis(const TileSet& tiles) {
  if (tiles.empty()) return Axis::X;
  const auto [south, north] = std::minmax_element(tiles.begin(), tiles.end(), [](auto a, auto b) { return a.y < b.y; });
  return north->y - south->y > tiles.rbegin()->x - tiles.begin()->x ? Axis::Y : Axis::X;
}

TileSet StageFront::due(Stage stage, const TileSet& tiles) const {
  TileSet due;
  for (const TileKey& key : tiles)
    if (isDue(stage, key)) due.insert(due.end(), key);
  return due;
}

std::vector<TileKey> StageFront::inRows(const TileSet& tiles) const {
  std::vector<TileKey> keys(tiles.begin(), tiles.end());
  if (axis_ == Axis::Y)
    std::sort(keys.begin(), keys.end(), [](auto a, auto b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); });
  return keys;
}

}  // namespace cluxel::perception
