// SPDX-License-Identifier: Apache-2.0
// Reads the tiles around a change, and nothing else of the map.
#include "mapping/window/map_window.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <unordered_map>

#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "perception/segments/primitive_inputs.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

struct WindowTiles {
  TileSet held, elsewhere;
};

/// Changed tiles may be gone: what lies around them counts.
WindowTiles tilesAround(const TileSet& changed, const TileSet& more, int rings, const TileSet& map) {
  WindowTiles tiles;
  TileSet around = changed;
  for (int ring = 0; ring < rings; ++ring) around = perception::grown(around);
  std::set_intersection(around.begin(), around.end(), map.begin(), map.end(),
                        std::inserter(tiles.held, tiles.held.end()));
  for (const TileKey& tile : more)
    if (map.contains(tile)) tiles.held.insert(tile);
  for (const TileKey& near : perception::withRing(tiles.held, map))
    if (!tiles.held.contains(near)) tiles.elsewhere.insert(near);
  return tiles;
}

/// False when the map lacks the layer of a tile that was there before the change. Tiles that had no summary then are
/// new, and have no layer that counts.
bool readLayers(const rdf::ReadTransaction& transaction, const OutputChanges& changes, MapWindow& window) {
  for (const TileKey& tile : window.tiles) {
    const auto changed = changes.former_summaries.find(tile);
    if (changed != changes.former_summaries.end() && !changed->second) continue;
    std::optional<TileLayer> layer = storedLayer(transaction, tile);
    if (!layer) return false;
    for (const TileLayer::PrimitiveHere& primitive : layer->primitives)
      window.known.emplace(primitive.id, KnownPrimitive{primitive.input, primitive.trace});
    window.layers.emplace(tile, std::move(*layer));
  }
  return true;
}

void requireFit(bool holds) {
  if (!holds) refuseDamaged("stored tiles and what was decided about them do not belong together");
}

/// Layers must be of the cluxels and components that the tiles had when they were written.
void requireFit(const TileSet& held, const TileStages& stages, const OutputChanges& changes, FormerSummaries& former,
                const std::map<TileKey, TileLayer>& layers) {
  for (const TileKey& tile : held) requireFit(stages.summaries().contains(tile) && stages.components().contains(tile));
  for (const auto& [tile, layer] : layers) {
    if (former.hasChanged(tile))
      requireFit(former.of(tile) != nullptr && former.of(tile)->size() == layer.size());
    else
      requireFit(held.contains(tile) && stages.summaries().at(tile).size() == layer.size());
    if (!changes.tiles.contains(tile)) requireFit(stages.components().at(tile).size() == layer.primitives.size());
  }
}

/// Calls `visit(hash, number)` for the seed of each cluxel of a tile.
template <typename Visit>
void forEachSeed(const perception::SummaryTile& tile, const Visit& visit) {
  perception::SceneSeeds seeds;
  seeds.scans = tile.scans;
  for (std::size_t c = 0; c < tile.size(); ++c) seeds.seed.push_back({tile.seed_scan[c], tile.seed_point[c]});
  const std::vector<std::uint64_t> hashes = perception::seedHashes(seeds);
  for (std::uint32_t c = 0; c < hashes.size(); ++c) visit(hashes[c], c);
}

}  // namespace

const perception::SummaryTile* FormerSummaries::of(const TileKey& tile) {
  const auto bytes = changes_.former_summaries.find(tile);
  if (bytes == changes_.former_summaries.end() || !bytes->second) return nullptr;
  const auto known = read_.find(tile);
  if (known != read_.end()) return &known->second;
  return &read_.emplace(tile, perception::summaryTileFromBytes(*bytes->second)).first->second;
}

std::optional<MapWindow> windowAround(const rdf::ReadTransaction& transaction, TileStages& stages,
                                      const OutputChanges& changes, FormerSummaries& former, const TileSet& map,
                                      const TileSet& more, int rings, const std::vector<Cloud>& clouds,
                                      double max_share) {
  WindowTiles tiles = tilesAround(changes.tiles, more, rings, map);
  if (static_cast<double>(tiles.held.size()) > max_share * static_cast<double>(map.size())) return std::nullopt;
  MapWindow window;
  window.tiles = perception::unionOf(tiles.held, changes.tiles);
  window.elsewhere = std::move(tiles.elsewhere);
  if (!readLayers(transaction, changes, window)) return std::nullopt;
  const TileSet around = without(perception::withRing(tiles.held, storedTiles(transaction)), tiles.held);
  stages.hold(transaction, tiles.held, around);
  requireFit(tiles.held, stages, changes, former, window.layers);
  perception::SceneWindow scene = stages.window(window.elsewhere, without(around, window.elsewhere), clouds);
  window.scene = std::move(scene.scene);
  window.is_cut = std::move(scene.is_cut);
  std::uint32_t first = 0;
  for (const auto& [tile, summary] : stages.summaries()) {
    window.first_cluxel.emplace(tile, first);
    for (const perception::Component& component : stages.components().at(tile).components)
      window.primitive_of_component[tile].push_back(window.scene.cluxels.primitive[first + component.first_cluxel]);
    first += static_cast<std::uint32_t>(summary.size());
  }
  return window;
}

std::vector<char> openPrimitives(const MapWindow& window, double reach_m) {
  std::vector<char> is_open = window.is_cut;
  std::map<TileKey, std::vector<Eigen::AlignedBox2d>> outside;  // by held tile
  const auto rings = static_cast<int>(std::ceil(reach_m / perception::kTileSize_m));
  for (const TileKey& away : window.elsewhere)
    for (int dx = -rings; dx <= rings; ++dx)
      for (int dy = -rings; dy <= rings; ++dy)
        if (const TileKey near{away.x + dx, away.y + dy}; window.first_cluxel.contains(near))
          outside[near].push_back(boxOfTile(window.scene.cluxels.grid, away));
  const perception::SceneCluxels& all = window.scene.cluxels;
  for (const auto& [tile, boxes] : outside)
    for (std::uint32_t c = window.first_cluxel.at(tile); c < all.size() && all.name[c].tile == tile; ++c) {
      const Eigen::Vector2d low = all.low_corner[c].head<2>();
      const Eigen::AlignedBox2d own(low, Eigen::Vector2d(low + all.extent[c].head<2>().cast<double>()));
      if (std::any_of(boxes.begin(), boxes.end(),
                      [&](const auto& box) { return box.exteriorDistance(own) <= reach_m; }))
        is_open[all.primitive[c]] = 1;
    }
  return is_open;
}

std::vector<std::uint32_t> formerNumbers(const MapWindow& window, const TileStages& stages, FormerSummaries& former) {
  std::vector<std::uint32_t> numbers;
  numbers.reserve(window.scene.cluxels.size());
  for (const auto& [tile, summary] : stages.summaries()) {
    if (!former.hasChanged(tile)) {
      for (std::uint32_t c = 0; c < summary.size(); ++c) numbers.push_back(c);
      continue;
    }
    std::unordered_map<std::uint64_t, std::uint32_t> number;
    if (const perception::SummaryTile* before = former.of(tile))
      forEachSeed(*before, [&](std::uint64_t seed, std::uint32_t c) { number.emplace(seed, c); });
    forEachSeed(summary, [&](std::uint64_t seed, std::uint32_t) {
      const auto found = number.find(seed);
      numbers.push_back(found == number.end() ? kNoFormer : found->second);
    });
  }
  return numbers;
}

}  // namespace cluxel::mapping
