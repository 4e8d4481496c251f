// SPDX-License-Identifier: Apache-2.0
// Volumes of cluxels and rows of features are not stored: they are computed where a stage reads them.
#include "perception/stage_inputs.hpp"

#include "base/parallel.hpp"
#include "perception/stage_tiles.hpp"

namespace cluxel::perception {

namespace {

constexpr std::uint32_t kEverywhere = 1U << kRingCentre;

bool holds(std::uint32_t there, std::uint32_t needed) {
  return (there & kEverywhere) != 0 || (needed & ~there) == 0;
}

/// Near which places a tile has something, if it has any.
std::uint32_t placesOf(bool has_some, const std::map<TileKey, std::uint32_t>& near, const TileKey& key) {
  if (!has_some) return 0;
  const auto found = near.find(key);
  return found == near.end() ? kEverywhere : found->second;
}

}  // namespace

void StageInputs::readOwn(const TileSet& tiles) {
  if (options_.store != nullptr) options_.store->load(tiles, out_);
}

void StageInputs::read(const TileSet& tiles) {
  readOwn(without(without(tiles, tiles_.forgotten), tiles_.lent));
  if (options_.donor != nullptr) options_.donor->load(commonOf(tiles, tiles_.lent), out_);
}

FeatureTile StageInputs::featuresOf(const TileKey& key) const {
  return computeFeatures(ringIn(out_.cluxels, key), ringIn(out_.ground, key), params_.features);
}

/// All of these tiles, and of the tiles around them what is near these: everything where stages read far.
StageInputs::Places StageInputs::around(const TileSet& keys) const {
  const bool is_far = widths_.volumes + widths_.points > kTileSize_m;
  Places places;
  for (const TileKey& key : keys) {
    const auto ring = ringOf(key);
    for (std::size_t place = 0; place < ring.size(); ++place)
      if (tiles_.all.contains(ring[place])) places[ring[place]] |= is_far ? kEverywhere : 1U << opposite(place);
  }
  return places;
}

void StageInputs::addVolumes(const Places& needed) {
  read(keysOf(needed));
  std::vector<std::pair<CluxelTile*, std::uint32_t>> lacking;
  TileSet whole;
  for (const auto& [key, places] : needed) {
    CluxelTile& tile = out_.cluxels.at(key);
    const std::uint32_t there = placesOf(tile.hasVolumes(), volumes_near_, key);
    if (holds(there, places)) continue;
    lacking.emplace_back(&tile, there | places);
    if ((places & kEverywhere) != 0) whole.insert(key);
  }
  read(tiles_.around(whole));
  parallelFor(lacking.size(), options_.threads, [&](std::size_t i) {
    const auto& [tile, places] = lacking[i];
    std::vector<std::uint32_t> chosen;
    const TilePoints& points = out_.points.at(tile->key);
    for (std::uint32_t c = 0; c < tile->size(); ++c)
      if (((kEverywhere | neighboursNear(points.at(tile->seed[c]), widths_.volumes)) & places) != 0)
        chosen.push_back(c);
    perception::addVolumes(ringIn(out_.points, tile->key), params_.clustering, std::move(chosen), *tile);
  });
  for (const auto& [tile, places] : lacking) volumes_near_[tile->key] = places;
}

void StageInputs::addRows(const TileSet& keys) {
  const Places needed = around(keys);
  read(keysOf(needed));
  std::vector<std::pair<FeatureTile*, std::uint32_t>> lacking;
  TileSet readers;
  for (const auto& [key, places] : needed) {
    FeatureTile& tile = out_.features.at(key);
    const std::uint32_t there = placesOf(tile.hasRows(), rows_near_, key);
    if (holds(there, places)) continue;
    lacking.emplace_back(&tile, there | places);
    if ((places & kEverywhere) != 0) readers.insert(key);
    for (const TileKey& near : ringOf(key))
      if (keys.contains(near)) readers.insert(near);
  }
  addVolumes(around(readers));
  parallelFor(lacking.size(), options_.threads, [&](std::size_t i) {
    const auto& [tile, places] = lacking[i];
    const CluxelTile& cluxels = out_.cluxels.at(tile->key);
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t c = 0; c < cluxels.size(); ++c)
      if (((kEverywhere | neighboursNear(cluxels.own[c].mean, widths_.features)) & places) != 0) chosen.push_back(c);
    perception::addRows(ringIn(out_.cluxels, tile->key), ringIn(out_.ground, tile->key), params_.features, chosen,
                        *tile);
  });
  for (const auto& [tile, places] : lacking) rows_near_[tile->key] = places;
}

void StageInputs::dropRowsBefore(std::int64_t row, Axis axis) {
  for (auto& [key, tile] : out_.features)
    if (rowOf(key, axis) < row) tile.dropRows();
}

void StageInputs::dropVolumesBefore(std::int64_t row, Axis axis) {
  for (auto& [key, tile] : out_.cluxels)
    if (rowOf(key, axis) < row) perception::dropVolumes(tile);
}

}  // namespace cluxel::perception
