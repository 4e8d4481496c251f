// SPDX-License-Identifier: Apache-2.0
// Volumes of cluxels and rows of features are not stored: they are computed where a stage reads them.
#include "perception/stage_inputs.hpp"

#include "base/parallel.hpp"
#include "perception/stage_tiles.hpp"

namespace cluxel::perception {

void StageInputs::readOwn(const TileSet& tiles) {
  if (options_.store != nullptr && !options_.compute_all) options_.store->load(tiles, out_);
}

void StageInputs::read(const TileSet& tiles) {
  readOwn(without(without(tiles, tiles_.forgotten), tiles_.lent));
  if (options_.donor != nullptr) options_.donor->load(commonOf(tiles, tiles_.lent), out_);
}

FeatureTile StageInputs::featuresOf(const TileKey& key) const {
  return computeFeatures(ringIn(out_.cluxels, key), ringIn(out_.ground, key), params_.features);
}

void StageInputs::addVolumesOf(const TileSet& keys) {
  read(keys);
  std::vector<CluxelTile*> lacking;
  TileSet measured;
  for (const TileKey& key : keys) {
    CluxelTile& tile = out_.cluxels.at(key);
    if (tile.hasVolumes()) continue;
    lacking.push_back(&tile);
    measured.insert(key);
  }
  read(tiles_.around(measured));
  parallelFor(lacking.size(), options_.threads, [&](std::size_t i) {
    addVolumes(ringIn(out_.points, lacking[i]->key), params_.clustering, *lacking[i]);
  });
}

void StageInputs::addRowsOf(const TileSet& keys) {
  read(keys);
  TileSet lacking;
  for (const TileKey& key : keys)
    if (!out_.features.at(key).hasRows()) lacking.insert(key);
  addVolumesOf(tiles_.around(lacking));
  const std::vector<TileKey> each(lacking.begin(), lacking.end());
  parallelFor(each.size(), options_.threads, [&](std::size_t i) { out_.features.at(each[i]) = featuresOf(each[i]); });
}

void StageInputs::dropRowsBefore(std::int32_t column) {
  for (auto& [key, tile] : out_.features)
    if (key.x < column) tile.dropRows();
}

void StageInputs::dropVolumes() {
  for (auto& [key, tile] : out_.cluxels) perception::dropVolumes(tile);
}

}  // namespace cluxel::perception
