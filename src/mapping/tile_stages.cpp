// SPDX-License-Identifier: Apache-2.0
// The order of the stages and how far a change of each reaches.
#include "mapping/tile_stages.hpp"

#include "mapping/scan_store.hpp"

namespace cluxel {

namespace {

TilePoints thinnedPoints(const std::vector<ScanSegment>& segments, const TileKey& key, const ThinParams& params) {
  std::vector<const ScanSegment*> pointers;
  pointers.reserve(segments.size());
  for (const ScanSegment& segment : segments) pointers.push_back(&segment);
  return thin(key, pointers, params);
}

}  // namespace

TileSet TileStages::updatePoints(WriteTransaction& transaction, const TileSet& touched, unsigned threads,
                                 ProgressSink& sink) {
  std::map<TileKey, std::vector<ScanSegment>> segments;
  for (const TileKey& tile : touched)
    transaction.forEachBlock(tables::kSegments, tables::keyOf(tile), [&](std::string_view, std::string_view bytes) {
      segments[tile].push_back(scanSegmentFromBytes(bytes));
    });
  return points_.recompute(transaction, touched, threads, sink, [&](const TileKey& key) {
    return thinnedPoints(segments.at(key), key, model_.perception.thin);
  });
}

/// A change of points reaches contacts five tiles away, which read components of the sixth.
void TileStages::loadAround(const ReadTransaction& transaction, const TileSet& tiles) {
  TileSet around = tiles;
  for (int ring = 0; ring < 6; ++ring) around = withRing(around, existing_);
  points_.load(transaction, around);
  cluxels_.load(transaction, around);
  ground_.load(transaction, around);
  features_.load(transaction, around);
  labels_.load(transaction, around);
  components_.load(transaction, around);
}

void TileStages::update(WriteTransaction& transaction, const TileSet& touched, unsigned threads, ProgressSink& sink) {
  existing_ = storedTiles(transaction);
  const TileSet points = updatePoints(transaction, touched, threads, sink);
  loadAround(transaction, points);
  const auto around = [&](const TileSet& tiles) { return withRing(tiles, existing_); };
  const TileSet cluxels = cluxels_.recompute(transaction, around(points), threads, sink, [&](const TileKey& key) {
    return coverTile(points_.ring(key), model_.perception.cover);
  });
  const TileSet ground = ground_.recompute(transaction, around(cluxels), threads, sink, [&](const TileKey& key) {
    return groundOf(cluxels_.ring(key), model_.perception.ground);
  });
  const TileSet features =
      features_.recompute(transaction, around(unionOf(cluxels, ground)), threads, sink, [&](const TileKey& key) {
        return computeFeatures(cluxels_.ring(key), ground_.ring(key), model_.perception.features);
      });
  const TileSet labels = labels_.recompute(transaction, around(features), threads, sink, [&](const TileKey& key) {
    return labeller_.label(features_.ring(key), params_.labelling);
  });
  const TileSet own = unionOf(unionOf(points, cluxels), unionOf(features, labels));
  const TileSet components =
      components_.recompute(transaction, unionOf(own, around(ground)), threads, sink, [&](const TileKey& key) {
        return componentsOf(points_.at(key), cluxels_.at(key), features_.at(key), labels_.at(key), ground_.ring(key),
                            params_.component);
      });
  contacts_.recompute(transaction, unionOf(own, around(unionOf(components, cluxels))), threads, sink,
                      [&](const TileKey& key) {
                        return contactsOf(components_.ring(key), cluxels_.ring(key), features_.at(key),
                                          params_.component, params_.contact);
                      });
}

void TileStages::loadAll(const ReadTransaction& transaction) {
  points_.loadAll(transaction);
  cluxels_.loadAll(transaction);
  ground_.loadAll(transaction);
  features_.loadAll(transaction);
  labels_.loadAll(transaction);
  components_.loadAll(transaction);
  contacts_.loadAll(transaction);
}

Scene TileStages::scene() const {
  const SceneTiles tiles{points_.tiles(), cluxels_.tiles(),    features_.tiles(), ground_.tiles(),
                         labels_.tiles(), components_.tiles(), contacts_.tiles()};
  return assembleScene(tiles, params_.relation);
}

}  // namespace cluxel
