// SPDX-License-Identifier: Apache-2.0
// Tiles name objects by their ids; readers count them in the order of these.
#include "mapping/regions/tile_objects.hpp"

#include <algorithm>

#include "base/free_memory.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/regions/tile_regions.hpp"
#include "mapping/stored_grid.hpp"
#include "perception/segments/summary_tile.hpp"
#include "perception/tile_borders.hpp"

namespace cluxel::mapping {

namespace {

using perception::GroundTile;
using perception::Ring;
using perception::SummaryTile;
using perception::TileKey;

[[noreturn]] void refuseUnfitTile() {
  refuseDamaged("a stored tile does not fit its objects");
}

/// Relative to the tile, rounded as in the scene.
CluxelHeight heightOf(const SummaryTile& tile, std::size_t cluxel, const Ring<GroundTile>& ground) {
  const Eigen::Vector3f& centre = tile.mean[cluxel];
  return {centre.z(), static_cast<float>(centre.z() - groundHeightAt(ground, centre.x(), centre.y()))};
}

/// Visits all tiles in the order of their keys.
template <typename Visit>
void forEachSummary(const MapReader& map, const Visit& visit) {
  const auto ground = groundOfTiles(map);
  for (const auto& [tile, here] : ground) {
    const std::string_view bytes = requiredBlock(map.transaction(), tables::kSummaries, tile);
    visit(ofTile(tile, perception::summaryTileFromBytes(bytes)), ringIn(ground, tile));
  }
}

std::vector<perception::TileSet> regionsOfTiles(const MapReader& map, const perception::TileSet& tiles,
                                                std::size_t max_cluxels) {
  std::vector<CountedTile> counted;
  for (const TileKey& tile : tiles)
    counted.push_back({tile, perception::cluxelsIn(requiredBlock(map.transaction(), tables::kSummaries, tile))});
  return regionsOf(std::move(counted), max_cluxels);
}

}  // namespace

std::vector<std::uint32_t> objectsInTile(const MapReader& map, const TileKey& tile) {
  const auto layer = storedLayer(map.transaction(), tile);
  if (!layer) refuseIncompleteTile();
  const std::vector<ContentHash>& ids = map.objectIds();
  std::vector<std::uint32_t> object_of_share;
  for (const TileLayer::Share& share : layer->shares) {
    const auto at = std::lower_bound(ids.begin(), ids.end(), share.object);
    if (at == ids.end() || *at != share.object) refuseDamaged("a tile names an object that is not there");
    object_of_share.push_back(static_cast<std::uint32_t>(at - ids.begin()));
  }
  std::vector<std::uint32_t> objects;
  objects.reserve(layer->size());
  for (const std::uint32_t share : layer->share_of_cluxel)
    objects.push_back(share == kNoShare ? kNoObjectOfPoint : object_of_share.at(share));
  return objects;
}

std::map<TileKey, perception::GroundTile> groundOfTiles(const MapReader& map) {
  std::map<TileKey, perception::GroundTile> ground;
  for (const TileKey& tile : storedTiles(map.transaction())) {
    const std::string_view bytes = perception::withoutBorders(requiredBlock(map.transaction(), tables::kGround, tile));
    ground.emplace(tile, ofTile(tile, perception::groundTileFromBytes(bytes)));
  }
  return ground;
}

std::vector<CluxelHeight> heightsOfCluxels(const MapReader& map) {
  std::vector<CluxelHeight> heights;
  const double corner_m = storedGrid(map.transaction()).corner().z();
  forEachSummary(map, [&](const SummaryTile& tile, const Ring<GroundTile>& ground) {
    for (std::size_t c = 0; c < tile.size(); ++c) {
      CluxelHeight& height = heights.emplace_back(heightOf(tile, c, ground));
      height.z_map_m = static_cast<float>(corner_m + height.z_map_m);
    }
  });
  return heights;
}

std::vector<double> topsOfObjects(const MapReader& map) {
  constexpr double no_cluxel = -1e300;
  std::vector<double> tops(map.objectIds().size(), no_cluxel);
  forEachSummary(map, [&](const SummaryTile& tile, const Ring<GroundTile>& ground) {
    const std::vector<std::uint32_t> objects = objectsInTile(map, tile.key);
    if (objects.size() != tile.size()) refuseUnfitTile();
    for (std::size_t c = 0; c < objects.size(); ++c) {
      if (objects[c] == kNoObjectOfPoint) continue;
      const auto [z_m, above_m] = heightOf(tile, c, ground);
      const double ground_m = static_cast<double>(z_m) - static_cast<double>(above_m);
      const double high_m = static_cast<double>(tile.box_min[c].z()) + static_cast<double>(tile.size_m[c].z());
      tops[objects[c]] = std::max(tops[objects[c]], high_m - ground_m);
    }
  });
  return tops;
}

void forEachTileOfPoints(const MapReader& map, const perception::TileSet& tiles,
                         const std::function<void(const TileOfPoints&)>& visit, std::size_t max_cluxels) {
  const MapInputs inputs = map.inputs();
  TileStages stages(map.model(), inputs.params);
  const std::vector<perception::TileSet> regions = regionsOfTiles(map, tiles, max_cluxels);
  for (const perception::TileSet& region : regions) {
    stages.dropPoints();
    stages.loadPoints(map.transaction(), region);
    for (const TileKey& tile : region) {
      const auto points = stages.points().find(tile);
      const auto cluxels = stages.cluxels().find(tile);
      if (points == stages.points().end() || cluxels == stages.cluxels().end()) refuseIncompleteTile();
      const std::vector<std::uint32_t> objects = objectsInTile(map, tile);
      if (objects.size() != cluxels->second.size()) refuseUnfitTile();
      TileOfPoints here{tile, points->second, {}};
      here.object.reserve(points->second.size());
      for (const std::uint32_t cluxel : cluxels->second.point_cluxel) here.object.push_back(objects.at(cluxel));
      if (here.object.size() != points->second.size()) refuseUnfitTile();
      visit(here);
    }
  }
  stages.dropAll();
  if (regions.size() > 1) returnFreeMemory();
}

}  // namespace cluxel::mapping
