// SPDX-License-Identifier: Apache-2.0
// A breadth-first search over the boxes of primitives, tile by tile. Only tiles that it reaches are read.
#include "mapping/window/likely_tiles.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <unordered_map>
#include <utility>
#include <vector>

#include "mapping/clouds/scan_store.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/stored_grid.hpp"
#include "mapping/window/map_window.hpp"
#include "rules/decide/local_reach.hpp"
#include "rules/objects/finished_objects.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

/// Layers are made of cells, so that they reach somewhat farther. Of 0, 1 and 2 m, 1 m gave two parts of a city the
/// fewest tiles with two attempts each.
constexpr double kSlack_m = 1;

/// What lies in one tile of a primitive.
struct Part {
  ContentHash primitive;
  Eigen::AlignedBox2d box;  ///< [m, map]
  bool is_reached = false;
};

/// The primitives of a tile, other than those of some objects.
std::vector<Part> partsIn(const TileLayer& layer, const perception::TileGrid& grid, const std::set<ContentHash>& but) {
  std::vector<char> is_left_out(layer.primitives.size(), 0);
  for (const TileLayer::Share& share : layer.shares)
    if (but.contains(share.object))
      for (const std::uint32_t component : share.components) is_left_out[component] = 1;
  const Eigen::Vector3d corner = grid.cornerOf(layer.key);
  std::vector<Part> parts;
  for (std::size_t i = 0; i < is_left_out.size(); ++i)
    if (is_left_out[i] == 0) parts.push_back({layer.primitives[i].id, boxInMap(layer.primitives[i], corner)});
  return parts;
}

/// Layers (rules::layersAround()), as far as the stored layers of tiles tell them.
class StoredLayerSearch {
 public:
  StoredLayerSearch(const rdf::ReadTransaction& transaction, TileSet map, const std::set<ContentHash>& lone_objects,
                    double reach_m)
      : transaction_(transaction),
        grid_(storedGrid(transaction)),
        lone_objects_(lone_objects),
        reach_m_(reach_m + kSlack_m),
        map_(std::move(map)) {}

  /// Everything in some tiles is layer 0.
  void beginWith(const TileSet& tiles) {
    begun_ = tiles;
    for (const TileKey& tile : tiles) {
      const auto ring = perception::ringOf(tile);
      // Within them there is nothing to find.
      if (!std::all_of(ring.begin(), ring.end(),
                       [&](const TileKey& near) { return tiles.contains(near) || !map_.contains(near); }))
        partsOf(tile);
    }
  }
  /// Some primitives, which have cluxels in these tiles, are layer 0.
  void beginWith(const std::set<ContentHash>& primitives, const TileSet& tiles) {
    for (const ContentHash& primitive : primitives) layer_of_.emplace(primitive, 0);
    for (const TileKey& tile : tiles) partsOf(tile);
  }

  /// The tiles within reach of the first `count` layers.
  TileSet tilesOfFirst(std::uint32_t count) {
    TileSet found;
    for (; layer_ < count; ++layer_)
      while (!reached_[layer_].empty())
        for (const auto& [tile, box] : std::exchange(reached_[layer_], {}))
          for (const TileKey& near : perception::ringOf(tile))
            if (map_.contains(near) && boxOfTile(grid_, near).exteriorDistance(box) <= reach_m_) {
              found.insert(near);
              lookIn(near, box);
            }
    return found;
  }

 private:
  using Place = std::pair<TileKey, std::size_t>;

  /// A part of a reached primitive is reached, too, when its tile is read: in the layer of the primitive, or now.
  std::vector<Part>& partsOf(const TileKey& tile) {
    const auto [place, is_new] = parts_.try_emplace(tile);
    std::vector<Part>& parts = place->second;
    const auto layer = is_new ? storedLayer(transaction_, tile) : std::nullopt;
    if (!layer) return parts;
    parts = partsIn(*layer, grid_, lone_objects_);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      places_[parts[i].primitive].emplace_back(tile, i);
      if (const auto reached = layer_of_.find(parts[i].primitive); reached != layer_of_.end())
        reach(tile, parts[i], std::max(reached->second, layer_));
      else if (begun_.contains(tile))
        reach(tile, parts[i], layer_);
    }
    return parts;
  }

  void lookIn(const TileKey& tile, const Eigen::AlignedBox2d& from) {
    for (Part& part : partsOf(tile))
      if (!part.is_reached && part.box.exteriorDistance(from) <= reach_m_)
        for (const auto& [other, number] : places_.at(part.primitive))
          reach(other, parts_.at(other)[number], layer_ + 1);
  }

  void reach(const TileKey& tile, Part& part, std::uint32_t layer) {
    if (std::exchange(part.is_reached, true)) return;
    layer_of_.emplace(part.primitive, layer);
    reached_[layer].emplace_back(tile, part.box);
  }

  const rdf::ReadTransaction& transaction_;
  perception::TileGrid grid_;
  const std::set<ContentHash>& lone_objects_;
  double reach_m_;
  TileSet map_, begun_;
  std::map<TileKey, std::vector<Part>> parts_;                  ///< of the tiles that were read
  std::unordered_map<ContentHash, std::vector<Place>> places_;  ///< of the parts of each primitive
  std::unordered_map<ContentHash, std::uint32_t> layer_of_;     ///< of the primitives that were reached
  std::uint32_t layer_ = 0;                                     ///< whose surroundings are looked at
  /// By layer the parts whose surroundings have to be looked at.
  std::map<std::uint32_t, std::vector<std::pair<TileKey, Eigen::AlignedBox2d>>> reached_;
};

}  // namespace

std::set<ContentHash> objectsOfLoneSeeds(const rules::RuleSet& rules) {
  std::set<ContentHash> objects;
  for (std::size_t i = 0; i < rules::strataOfLoneSeeds(rules); ++i) {
    rules::SemanticObject object;
    object.class_iri = rules.strata[i].front(), object.is_class_wide = true;
    objects.insert(rules::idOf({}, object));
  }
  return objects;
}

TileSet likelyTiles(const rdf::ReadTransaction& transaction, const TileSet& map, const TileSet& changed,
                    const std::set<ContentHash>& lone_objects, double reach_m, std::uint32_t layers) {
  StoredLayerSearch search(transaction, map, lone_objects, reach_m);
  search.beginWith(changed);
  return search.tilesOfFirst(layers);
}

TileSet tilesAround(const rdf::ReadTransaction& transaction, const std::set<ContentHash>& primitives,
                    const TileSet& tiles, const std::set<ContentHash>& lone_objects, double reach_m,
                    std::uint32_t layers) {
  StoredLayerSearch search(transaction, storedTiles(transaction), lone_objects, reach_m);
  search.beginWith(primitives, tiles);
  return perception::unionOf(search.tilesOfFirst(layers), tiles);
}

}  // namespace cluxel::mapping
