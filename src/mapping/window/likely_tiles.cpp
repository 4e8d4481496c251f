// SPDX-License-Identifier: Apache-2.0
// A breadth-first search over the boxes of primitives, tile by tile. Only tiles that it reaches are read.
#include "mapping/window/likely_tiles.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "mapping/build/scan_store.hpp"
#include "mapping/layers/stored_layers.hpp"
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
std::vector<Part> partsIn(const TileLayer& layer, const std::set<ContentHash>& but) {
  std::vector<char> is_left_out(layer.primitives.size(), 0);
  for (const TileLayer::Share& share : layer.shares)
    if (but.contains(share.object))
      for (const std::uint32_t component : share.components) is_left_out[component] = 1;
  std::vector<Part> parts;
  for (std::size_t i = 0; i < is_left_out.size(); ++i)
    if (is_left_out[i] == 0) parts.push_back({layer.primitives[i].id, boxInMap(layer.primitives[i], layer.key)});
  return parts;
}

/// Layers (rules::layersAround()), as far as the stored layers of tiles tell them.
class LayerSearch {
 public:
  LayerSearch(const rdf::ReadTransaction& transaction, TileSet map, const std::set<ContentHash>& lone_objects,
              double reach_m)
      : transaction_(transaction), lone_objects_(lone_objects), reach_m_(reach_m + kSlack_m), map_(std::move(map)) {}

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
    primitives_.insert(primitives.begin(), primitives.end());
    for (const TileKey& tile : tiles) partsOf(tile);
  }

  /// The tiles within reach of the first `count` layers.
  TileSet tilesOfFirst(std::uint32_t count) {
    TileSet found;
    for (std::uint32_t layer = 0; layer < count && !reached_.empty(); ++layer)
      for (const auto& [tile, box] : std::exchange(reached_, {}))
        for (const TileKey& near : perception::ringOf(tile))
          if (map_.contains(near) && boxOfTile(near).exteriorDistance(box) <= reach_m_) {
            found.insert(near);
            lookIn(near, box);
          }
    return found;
  }

 private:
  using Place = std::pair<TileKey, std::size_t>;

  /// What is layer 0, or part of a reached primitive, counts as reached when its tile is read.
  std::vector<Part>& partsOf(const TileKey& tile) {
    const auto [place, is_new] = parts_.try_emplace(tile);
    std::vector<Part>& parts = place->second;
    const auto layer = is_new ? storedLayer(transaction_, tile) : std::nullopt;
    if (!layer) return parts;
    parts = partsIn(*layer, lone_objects_);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      places_[parts[i].primitive].emplace_back(tile, i);
      if (begun_.contains(tile) || primitives_.contains(parts[i].primitive)) reach(tile, parts[i]);
    }
    return parts;
  }

  void lookIn(const TileKey& tile, const Eigen::AlignedBox2d& from) {
    for (Part& part : partsOf(tile))
      if (!part.is_reached && part.box.exteriorDistance(from) <= reach_m_)
        for (const auto& [other, number] : places_.at(part.primitive)) reach(other, parts_.at(other)[number]);
  }

  void reach(const TileKey& tile, Part& part) {
    if (std::exchange(part.is_reached, true)) return;
    primitives_.insert(part.primitive);
    reached_.emplace_back(tile, part.box);
  }

  const rdf::ReadTransaction& transaction_;
  const std::set<ContentHash>& lone_objects_;
  double reach_m_;
  TileSet map_, begun_;
  std::map<TileKey, std::vector<Part>> parts_;                    ///< of the tiles that were read
  std::unordered_map<ContentHash, std::vector<Place>> places_;    ///< of the parts of each primitive
  std::unordered_set<ContentHash> primitives_;                    ///< that were reached
  std::vector<std::pair<TileKey, Eigen::AlignedBox2d>> reached_;  ///< in the last layer
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
  LayerSearch search(transaction, map, lone_objects, reach_m);
  search.beginWith(changed);
  return search.tilesOfFirst(layers);
}

TileSet tilesAround(const rdf::ReadTransaction& transaction, const std::set<ContentHash>& primitives,
                    const TileSet& tiles, const std::set<ContentHash>& lone_objects, double reach_m,
                    std::uint32_t layers) {
  LayerSearch search(transaction, storedTiles(transaction), lone_objects, reach_m);
  search.beginWith(primitives, tiles);
  return perception::unionOf(search.tilesOfFirst(layers), tiles);
}

}  // namespace cluxel::mapping
