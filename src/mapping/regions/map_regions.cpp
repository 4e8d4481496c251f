// SPDX-License-Identifier: Apache-2.0
// A region holds the stored outputs of its tiles, and of those of its objects.
#include "mapping/regions/map_regions.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "mapping/build/cluxel_finder.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/regions/tile_regions.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

[[noreturn]] void failUnfit() {
  refuseDamaged("stored tiles and what was decided about them do not belong together");
}

/// The tiles cover this in plan view [m].
Eigen::AlignedBox2d areaOf(const TileSet& tiles, const perception::TileGrid& grid) {
  Eigen::AlignedBox2d area;
  for (const TileKey& tile : tiles) {
    const Eigen::Vector2d corner = grid.cornerOf(tile).head<2>();
    area.extend(corner), area.extend(Eigen::Vector2d(corner + Eigen::Vector2d::Constant(perception::kTileSize_m)));
  }
  return area;
}

}  // namespace

struct MapRegions::RegionPoints {
  struct Tile {
    CluxelFinder finder;
    std::uint32_t first;  ///< cluxel in the scene of the region
  };
  std::map<TileKey, Tile> tiles;
};

MapRegions::MapRegions(const MapReader& map, std::size_t max_cluxels) : map_(map), inputs_(map.inputs()) {
  std::vector<CountedTile> tiles;
  std::uint32_t first = 0;
  forEachStoredLayer(map.transaction(), [&](const TileLayer& layer) {
    all_tiles_.insert(layer.key);
    first_cluxel_.emplace(layer.key, first);
    first += static_cast<std::uint32_t>(layer.size());
    tiles.push_back({layer.key, layer.size()});
  });
  regions_ = regionsOf(std::move(tiles), max_cluxels);
  const std::string ground = rdf::vocabulary::clx("Ground");
  forEachRecord(map.transaction(), [&](const ContentHash&, const ObjectRecord& record) {
    const auto number = static_cast<std::uint32_t>(is_ground_.size());
    is_ground_.push_back(record.class_iri == ground);
    if (!is_ground_.back() && !record.tiles.empty()) objects_of_tile_[record.tiles.front()].push_back(number);
  });
  stages_ = std::make_unique<TileStages>(map.model(), inputs_.params);
}
MapRegions::~MapRegions() = default;

MapRegion MapRegions::read(std::size_t number) {
  points_.reset();
  stages_->dropPoints();
  MapRegion region;
  region.tiles = regions_[number];
  TileSet held = perception::withRing(region.tiles, all_tiles_);
  for (const TileKey& tile : region.tiles)
    if (const auto here = objects_of_tile_.find(tile); here != objects_of_tile_.end())
      for (const std::uint32_t object : here->second) {
        const auto record = storedRecord(map_.transaction(), map_.objectIds()[object]);
        if (!record) failUnfit();
        held.insert(record->tiles.begin(), record->tiles.end());
        region.number_of_objects.push_back(object);
        region.objects.emplace_back().class_iri = record->class_iri;
      }
  const TileSet around = without(perception::withRing(held, all_tiles_), held);
  stages_->hold(map_.transaction(), held, around);
  region.scene.cluxels = stages_->heldCluxels(around);
  readObjects(region);
  return region;
}

void MapRegions::readObjects(MapRegion& region) const {
  std::map<std::uint32_t, std::vector<std::uint32_t>> cluxels_of;
  for (const std::uint32_t object : region.number_of_objects) cluxels_of[object];
  for (const auto& [tile, summary] : stages_->summaries()) {
    const auto layer = storedLayer(map_.transaction(), tile);
    if (!layer || layer->size() != summary.size()) failUnfit();
    std::vector<std::uint32_t> object_of_share;
    for (const TileLayer::Share& share : layer->shares) {
      const auto& ids = map_.objectIds();
      const auto at = std::lower_bound(ids.begin(), ids.end(), share.object);
      if (at == ids.end() || *at != share.object) failUnfit();
      object_of_share.push_back(static_cast<std::uint32_t>(at - ids.begin()));
    }
    const bool is_own = region.tiles.contains(tile);
    for (std::uint32_t c = 0; c < layer->size(); ++c) {
      const std::uint32_t share = layer->share_of_cluxel[c];
      const std::uint32_t object = share == kNoShare ? kNoObject : object_of_share[share];
      if (const auto here = cluxels_of.find(object); here != cluxels_of.end())
        here->second.push_back(static_cast<std::uint32_t>(region.object.size()));
      region.object.push_back(object);
      region.number.push_back(first_cluxel_.at(tile) + c);
      region.is_own.push_back(is_own);
    }
  }
  for (std::size_t i = 0; i < region.objects.size(); ++i)
    region.objects[i].parts = {{region.objects[i].class_iri, {}, std::move(cluxels_of[region.number_of_objects[i]])}};
}

void MapRegions::readPoints(const MapRegion& region) {
  stages_->loadPoints(map_.transaction(), region.tiles);
  points_ = std::make_unique<RegionPoints>();
  std::uint32_t first = 0;
  for (const auto& [tile, summary] : stages_->summaries()) {
    if (region.tiles.contains(tile)) {
      const CluxelFinder finder(region.scene.cluxels.grid, *stages_, tile, map_.model().perception.thin);
      points_->tiles.emplace(tile, RegionPoints::Tile{finder, first});
    }
    first += static_cast<std::uint32_t>(summary.size());
  }
}

void MapRegions::forEachPoint(const MapRegion& region, const Cloud& cloud, const PointVisit& visit) {
  const Eigen::AlignedBox2d measured(cloud.min.head<2>(), cloud.max.head<2>());
  const perception::TileGrid& grid = region.scene.cluxels.grid;
  if (!areaOf(region.tiles, grid).intersects(measured)) return;
  if (!points_) readPoints(region);
  const scan::ScanPoints points = map_.pointsOf(cloud.id);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p_map = scan::toMap(cloud.T_map_sensor, {points.x[i], points.y[i], points.z[i]});
    const TileKey key = grid.tileOf(p_map);
    const auto tile = points_->tiles.find(key);
    if (tile == points_->tiles.end()) continue;
    visit(p_map, tile->second.first + tile->second.finder.cluxelOf(p_map), i);
  }
}

}  // namespace cluxel::mapping
