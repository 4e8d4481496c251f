// SPDX-License-Identifier: Apache-2.0
// One stage after the other over all tiles.
#include "cluxel/perception/scene_pipeline.hpp"

#include <vector>

#include "cluxel/base/parallel.hpp"

namespace cluxel {

namespace {

/// The output of one stage for every tile.
template <typename Tile, typename Compute>
std::map<TileKey, Tile> overTiles(const std::map<TileKey, FeatureTile>& tiles, unsigned threads,
                                  const Compute& compute) {
  std::vector<TileKey> keys;
  for (const auto& [key, tile] : tiles) keys.push_back(key);
  std::vector<Tile> outputs(keys.size());
  parallelFor(keys.size(), threads, [&](std::size_t i) { outputs[i] = compute(keys[i]); });
  std::map<TileKey, Tile> all;
  for (std::size_t i = 0; i < keys.size(); ++i) all.emplace(keys[i], std::move(outputs[i]));
  return all;
}

}  // namespace

Scene sceneOf(std::span<const Scan> scans, const LabelModel& model, const SceneParams& params, unsigned threads) {
  const PerceivedTiles tiles = perceive(scans, model.perception, threads);
  const TileLabeller labeller(model);
  const auto labels = overTiles<LabelTile>(tiles.features, threads, [&](const TileKey& key) {
    return labeller.label(ringIn(tiles.features, key), params.labelling);
  });
  const auto components = overTiles<ComponentTile>(tiles.features, threads, [&](const TileKey& key) {
    return componentsOf(tiles.points.at(key), tiles.cluxels.at(key), tiles.features.at(key), labels.at(key),
                        ringIn(tiles.ground, key), params.component);
  });
  const auto contacts = overTiles<ContactTile>(tiles.features, threads, [&](const TileKey& key) {
    return contactsOf(ringIn(components, key), ringIn(tiles.cluxels, key), tiles.features.at(key), params.component,
                      params.contact);
  });
  return assembleScene({tiles.points, tiles.cluxels, tiles.features, tiles.ground, labels, components, contacts},
                       params.relation);
}

}  // namespace cluxel
