// SPDX-License-Identifier: Apache-2.0
// The part is the window of a change (mapping/window) in which nothing changed.
#include "mapping/map_part.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "mapping/clouds/scan_store.hpp"
#include "mapping/layers/primitive_tiles.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/stored_grid.hpp"
#include "mapping/window/likely_tiles.hpp"
#include "mapping/window/map_window.hpp"

namespace cluxel::mapping {

namespace {

constexpr std::size_t kManyTiles = 25;  ///< of a near object: chosen, about as many as one more ring has

using PartsByName = std::map<std::string, rules::ObjectPart>;

/// What the layers of the tiles say of objects.
std::vector<rules::SemanticObject> objectsIn(const rdf::ReadTransaction& transaction, const MapWindow& window) {
  std::map<ContentHash, PartsByName> parts;
  const perception::SceneCluxels& all = window.scene.cluxels;
  for (const auto& [tile, layer] : window.layers) {
    const std::uint32_t first = window.first_cluxel.at(tile);
    for (std::uint32_t c = 0; c < layer.size(); ++c) {
      if (layer.share_of_cluxel[c] == kNoShare) continue;
      const TileLayer::Share& share = layer.shares[layer.share_of_cluxel[c]];
      rules::ObjectPart& part = parts[share.object][share.part_class];
      part.part_class = share.part_class;
      part.cluxels.push_back(first + c);
      part.primitives.push_back(all.primitive[first + c]);
    }
  }
  std::vector<rules::SemanticObject> objects;
  for (auto& [id, by_name] : parts) {
    const std::optional<ObjectRecord> record = storedRecord(transaction, id);
    if (!record) continue;
    rules::SemanticObject& object = objects.emplace_back();
    object.id = id, object.is_class_wide = record->is_class_wide;
    object.class_iri = record->class_iri, object.rule_id = record->rule_id, object.confidence = record->confidence;
    for (auto& [name, part] : by_name) {
      std::sort(part.primitives.begin(), part.primitives.end());
      part.primitives.erase(std::unique(part.primitives.begin(), part.primitives.end()), part.primitives.end());
      object.parts.push_back(std::move(part));
    }
  }
  return objects;
}

}  // namespace

std::optional<MapPart> partOfMap(const rdf::ReadTransaction& transaction, TileStages& stages,
                                 const perception::TileSet& tiles, double reach_m, double max_share) {
  if (tiles.empty()) return std::nullopt;
  const OutputChanges none;
  FormerSummaries former(none);
  std::optional<MapWindow> window = windowAround(transaction, stages, none, former, storedTiles(transaction), tiles, 0,
                                                 storedClouds(transaction), max_share);
  if (!window) return std::nullopt;
  MapPart part;
  part.objects = objectsIn(transaction, *window);
  for (std::size_t i = 0; i < window->scene.primitives.size(); ++i) {
    const auto known = window->known.find(window->scene.primitives[i].id);
    part.traces.push_back(window->is_cut[i] != 0 || known == window->known.end() ? 0 : known->second.trace);
  }
  part.is_open = openPrimitives(*window, reach_m);
  part.scene = std::move(window->scene);
  return part;
}

bool haveMoreCluxels(const rdf::ReadTransaction& transaction, const perception::TileSet& tiles, std::size_t most) {
  std::size_t cluxels = 0;
  return std::any_of(tiles.begin(), tiles.end(), [&](const perception::TileKey& tile) {
    if (const std::optional<TileLayer> layer = storedLayer(transaction, tile)) cluxels += layer->size();
    return cluxels > most;
  });
}

ThingPlace placeOfObject(const rdf::ReadTransaction& transaction, const ContentHash& object) {
  ThingPlace place{{}, tilesOfObject(transaction, object)};
  for (const perception::TileKey& tile : place.tiles)
    if (const std::optional<TileLayer> layer = storedLayer(transaction, tile))
      for (const TileLayer::Share& share : layer->shares)
        if (share.object == object)
          for (const std::uint32_t component : share.components)
            place.primitives.insert(layer->primitives[component].id);
  return place;
}

ThingPlace placeOfPrimitive(const rdf::ReadTransaction& transaction, const ContentHash& primitive) {
  return {{primitive}, tilesOfPrimitive(transaction, primitive)};
}

std::optional<MapPart> partOfLayers(const rdf::ReadTransaction& transaction, TileStages& stages,
                                    const ThingPlace& thing, const rules::RuleSet& rules, double reach_m,
                                    const LayersAround& around) {
  if (thing.tiles.empty()) return std::nullopt;
  const perception::TileSet tiles = tilesAround(transaction, thing.primitives, thing.tiles, objectsOfLoneSeeds(rules),
                                                reach_m + around.wider_m, around.count);
  return partOfMap(transaction, stages, tiles, reach_m);
}

perception::TileSet tilesOfPrimitives(const rdf::ReadTransaction& transaction, const ThingPlace& thing) {
  return perception::unionOf(PrimitiveTiles(transaction).beyond(thing.tiles, thing.primitives), thing.tiles);
}

perception::TileSet tilesOfNearObjects(const rdf::ReadTransaction& transaction, const ThingPlace& thing,
                                       const perception::TileSet& tiles, double near_m) {
  std::vector<TileLayer> layers;
  for (const perception::TileKey& tile : perception::grown(tiles))
    if (std::optional<TileLayer> layer = storedLayer(transaction, tile)) layers.push_back(*std::move(layer));
  const perception::TileGrid grid = storedGrid(transaction);
  Eigen::AlignedBox2d box;
  for (const TileLayer& layer : layers)
    for (const TileLayer::PrimitiveHere& here : layer.primitives)
      if (thing.primitives.contains(here.id)) box.extend(boxInMap(here, grid.cornerOf(layer.key)));
  std::set<ContentHash> near;
  for (const TileLayer& layer : layers)
    for (const TileLayer::Share& share : layer.shares)
      if (std::any_of(share.components.begin(), share.components.end(), [&](const std::uint32_t component) {
            return box.exteriorDistance(boxInMap(layer.primitives[component], grid.cornerOf(layer.key))) <= near_m;
          }))
        near.insert(share.object);
  perception::TileSet of_near;
  for (const ContentHash& object : near) {
    const std::optional<ObjectRecord> record = storedRecord(transaction, object);
    if (record && !record->is_class_wide && record->tiles.size() <= kManyTiles)
      of_near.insert(record->tiles.begin(), record->tiles.end());
  }
  return of_near;
}

perception::TileSet tilesOfObject(const rdf::ReadTransaction& transaction, const ContentHash& object) {
  const std::optional<ObjectRecord> record = storedRecord(transaction, object);
  if (!record) return {};
  return {record->tiles.begin(), record->tiles.end()};
}

std::optional<PrimitivePlace> samplePrimitiveOf(const rdf::ReadTransaction& transaction, const ContentHash& object) {
  const std::optional<ObjectRecord> record = storedRecord(transaction, object);
  if (!record || record->tiles.empty()) return std::nullopt;
  const perception::TileKey tile = record->tiles[record->tiles.size() / 2];
  const std::optional<TileLayer> layer = storedLayer(transaction, tile);
  if (!layer) return std::nullopt;
  std::optional<PrimitivePlace> sample;
  float widest_m2 = -1;
  for (const TileLayer::Share& share : layer->shares) {
    if (share.object != object) continue;
    for (const std::uint32_t component : share.components) {
      const TileLayer::PrimitiveHere& here = layer->primitives[component];
      const float area_m2 = here.bounds.sizes().head<2>().prod();
      if (area_m2 < widest_m2 || (area_m2 == widest_m2 && sample->primitive < here.id)) continue;
      widest_m2 = area_m2;
      sample = {here.id, tile};
    }
  }
  return sample;
}

perception::TileSet tilesOfPrimitive(const rdf::ReadTransaction& transaction, const ContentHash& primitive) {
  perception::TileSet tiles;
  forEachStoredLayer(transaction, [&](const TileLayer& layer) {
    for (const TileLayer::PrimitiveHere& here : layer.primitives)
      if (here.id == primitive) tiles.insert(layer.key);
  });
  return tiles;
}

}  // namespace cluxel::mapping
