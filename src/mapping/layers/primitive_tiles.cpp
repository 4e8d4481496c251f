// SPDX-License-Identifier: Apache-2.0
// A flood over tiles that hold one of the primitives.
#include "mapping/layers/primitive_tiles.hpp"

#include <algorithm>
#include <vector>

#include "mapping/layers/stored_layers.hpp"

namespace cluxel::mapping {

perception::TileSet PrimitiveTiles::beyond(const perception::TileSet& from, const std::set<ContentHash>& primitives,
                                           const IsLeftOut& is_left_out) {
  const auto holds_some = [&](const perception::TileKey& tile) {
    const std::set<ContentHash>& here = primitivesIn(tile);
    return std::any_of(primitives.begin(), primitives.end(), [&](const auto& one) { return here.contains(one); });
  };
  perception::TileSet found, seen = from;
  std::vector<perception::TileKey> open(from.begin(), from.end());
  while (!open.empty()) {
    const perception::TileKey tile = open.back();
    open.pop_back();
    for (const perception::TileKey& near : perception::ringOf(tile)) {
      if (!seen.insert(near).second || (is_left_out && is_left_out(near)) || !holds_some(near)) continue;
      found.insert(near);
      open.push_back(near);
    }
  }
  return found;
}

const std::set<ContentHash>& PrimitiveTiles::primitivesIn(const perception::TileKey& tile) {
  const auto [place, is_new] = known_.try_emplace(tile);
  if (is_new)
    if (const auto layer = storedLayer(transaction_, tile))
      for (const TileLayer::PrimitiveHere& here : layer->primitives) place->second.insert(here.id);
  return place->second;
}

}  // namespace cluxel::mapping
