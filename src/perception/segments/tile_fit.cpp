// SPDX-License-Identifier: Apache-2.0
// Compares sizes, and the targets of edges and contacts.
#include "perception/segments/tile_fit.hpp"

#include <algorithm>
#include <string>

#include "cluxel/error.hpp"

namespace cluxel::perception {

namespace {

void require(bool holds, const TileKey& key, const char* what) {
  if (holds) return;
  throw Error(ErrorKind::StoreUnavailable, "stored blocks of tile (" + std::to_string(key.x) + ", " +
                                               std::to_string(key.y) + ") do not belong together: " + what +
                                               "; the map is damaged, build it anew");
}

/// The number of items in each tile of the ring; 0 where there is no tile.
template <typename Tiles>
std::array<std::size_t, 9> sizesAround(const Tiles& tiles, const TileKey& key) {
  std::array<std::size_t, 9> sizes{};
  const auto ring = ringIn(tiles, key);
  for (std::size_t r = 0; r < sizes.size(); ++r) sizes[r] = ring[r] == nullptr ? 0 : ring[r]->size();
  return sizes;
}

void checkLengths(const TileOutputs& tiles, const TileKey& key, const SummaryTile& summary) {
  const bool all = tiles.features.contains(key) && tiles.ground.contains(key) && tiles.labels.contains(key) &&
                   tiles.components.contains(key) && tiles.contacts.contains(key);
  require(all, key, "a block is missing");
  require(tiles.features.at(key).size() == summary.size(), key, "its features are of other cluxels");
  require(tiles.labels.at(key).label.size() == summary.size(), key, "its labels are of other cluxels");
  require(tiles.components.at(key).component_of.size() == summary.size(), key, "its components are of other cluxels");
}

}  // namespace

std::array<bool, 9> ringAmong(const TileSet& tiles, const TileKey& key) {
  std::array<bool, 9> among{};
  if (tiles.empty()) return among;
  const auto ring = ringOf(key);
  for (std::size_t r = 0; r < among.size(); ++r) among[r] = tiles.contains(ring[r]);
  return among;
}

void checkFit(const TileOutputs& tiles, const TileSet& elsewhere) {
  for (const auto& [key, summary] : tiles.summaries) {
    checkLengths(tiles, key, summary);
    const auto ring_cluxels = sizesAround(tiles.summaries, key), ring_components = sizesAround(tiles.components, key);
    const auto is_elsewhere = ringAmong(elsewhere, key);
    const auto& edges = tiles.features.at(key).edge_target;
    require(std::all_of(edges.begin(), edges.end(),
                        [&](const RingIndex& to) { return is_elsewhere[to.ring] || to.index < ring_cluxels[to.ring]; }),
            key, "an edge leads to a cluxel that is not there");
    const auto& contacts = tiles.contacts.at(key).contacts;
    const auto is_there = [&](const Contact& contact) {
      return contact.from < ring_components[kRingCentre] &&
             (is_elsewhere[contact.to_ring] || contact.to < ring_components[contact.to_ring]);
    };
    require(std::all_of(contacts.begin(), contacts.end(), is_there), key,
            "a contact is with a component that is not there");
  }
  require(tiles.components.size() == tiles.summaries.size() && tiles.contacts.size() == tiles.summaries.size(), {},
          "a block has no tile");
}

}  // namespace cluxel::perception
