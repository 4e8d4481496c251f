// SPDX-License-Identifier: Apache-2.0
// Stage after stage over all tiles; within a stage the tiles are independent of each other.
#include "cluxel/perception/tile_pipeline.hpp"

#include <vector>

#include "cluxel/base/parallel.hpp"

namespace cluxel {
namespace {

std::vector<TileKey> keysOf(const std::map<TileKey, std::vector<ScanSegment>>& segments) {
  std::vector<TileKey> keys;
  for (const auto& [key, parts] : segments) keys.push_back(key);
  return keys;
}

/// Fills one stage's tiles: every place is made first, so that threads write only what is theirs.
template <typename Tile, typename Stage>
std::map<TileKey, Tile> runStage(const std::vector<TileKey>& keys, unsigned threads, const Stage& stage) {
  std::map<TileKey, Tile> tiles;
  std::vector<Tile*> places;
  for (const auto& key : keys) places.push_back(&tiles[key]);
  parallelFor(keys.size(), threads, [&](std::size_t i) { *places[i] = stage(keys[i]); });
  return tiles;
}

TilePoints thinTile(const TileKey& key, const std::vector<ScanSegment>& parts, const ThinParams& params) {
  std::vector<const ScanSegment*> pointers;
  for (const auto& part : parts) pointers.push_back(&part);
  return thin(key, pointers, params);
}

}  // namespace

void describe(PerceptionParams& params, ParameterVisitor& visitor) {
  describe(params.thin, visitor);
  describe(params.cover, visitor);
  describe(params.ground, visitor);
  describe(params.features, visitor);
}

PerceivedTiles perceive(std::span<const Scan> scans, const PerceptionParams& params, unsigned threads) {
  checkRanges(params);
  std::map<TileKey, std::vector<ScanSegment>> segments;
  for (const auto& scan : scans)
    for (auto& [key, segment] : splitScan(scan)) segments[key].push_back(std::move(segment));
  const auto keys = keysOf(segments);
  PerceivedTiles tiles;
  tiles.points = runStage<TilePoints>(keys, threads,
                                      [&](const TileKey& key) { return thinTile(key, segments.at(key), params.thin); });
  segments.clear();
  tiles.cluxels = runStage<CluxelTile>(
      keys, threads, [&](const TileKey& key) { return coverTile(ringIn(tiles.points, key), params.cover); });
  tiles.ground = runStage<GroundTile>(
      keys, threads, [&](const TileKey& key) { return groundOf(ringIn(tiles.cluxels, key), params.ground); });
  tiles.features = runStage<FeatureTile>(keys, threads, [&](const TileKey& key) {
    return computeFeatures(ringIn(tiles.cluxels, key), ringIn(tiles.ground, key), params.features);
  });
  return tiles;
}

}  // namespace cluxel
