// SPDX-License-Identifier: Apache-2.0
// Lengths and numbers of blocks, compared with those that they speak of.
#include "perception/scene_check.hpp"

#include <algorithm>
#include <array>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel {
namespace {

void require(bool holds, const TileKey& key, const char* what) {
  if (holds) return;
  throw Error(ExitCode::StoreUnavailable, "stored blocks of tile (" + std::to_string(key.x) + ", " +
                                              std::to_string(key.y) + ") do not belong together: " + what +
                                              "; the map is damaged, build it anew");
}

/// How many things each tile of the ring has; 0 where there is none.
template <typename Tiles>
std::array<std::size_t, 9> sizesAround(const Tiles& tiles, const TileKey& key) {
  std::array<std::size_t, 9> sizes{};
  const auto ring = ringIn(tiles, key);
  for (std::size_t r = 0; r < sizes.size(); ++r) sizes[r] = ring[r] == nullptr ? 0 : ring[r]->size();
  return sizes;
}

void checkLengths(const SceneTiles& tiles, const TileKey& key, const CluxelTile& cluxels) {
  const bool all = tiles.points.contains(key) && tiles.features.contains(key) && tiles.ground.contains(key) &&
                   tiles.labels.contains(key) && tiles.components.contains(key) && tiles.contacts.contains(key);
  require(all, key, "a block is missing");
  require(cluxels.point_cluxel.size() == tiles.points.at(key).size(), key, "its cluxels are of other points");
  require(tiles.features.at(key).size() == cluxels.size(), key, "its features are of other cluxels");
  require(tiles.labels.at(key).label.size() == cluxels.size(), key, "its labels are of other cluxels");
  require(tiles.components.at(key).component_of.size() == cluxels.size(), key, "its components are of other cluxels");
}

}  // namespace

void checkFit(const SceneTiles& tiles) {
  for (const auto& [key, cluxels] : tiles.cluxels) {
    checkLengths(tiles, key, cluxels);
    const auto ring_cluxels = sizesAround(tiles.cluxels, key), ring_components = sizesAround(tiles.components, key);
    const auto& edges = tiles.features.at(key).edge_target;
    require(
        std::all_of(edges.begin(), edges.end(), [&](const RingIndex& to) { return to.index < ring_cluxels[to.ring]; }),
        key, "an edge leads to a cluxel that is not there");
    const auto& contacts = tiles.contacts.at(key).contacts;
    const auto is_there = [&](const Contact& contact) {
      return contact.from < ring_components[kRingCentre] && contact.to < ring_components[contact.to_ring];
    };
    require(std::all_of(contacts.begin(), contacts.end(), is_there), key,
            "a contact is with a component that is not there");
  }
  require(tiles.components.size() == tiles.cluxels.size() && tiles.contacts.size() == tiles.cluxels.size(), {},
          "a block has no tile");
}

}  // namespace cluxel
