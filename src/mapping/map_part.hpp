// SPDX-License-Identifier: Apache-2.0
// The part of a map that lies in some tiles, read without the rest of the map.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "mapping/build/tile_stages.hpp"
#include "perception/segments/scene.hpp"
#include "rules/language/rule_set.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// All numbers refer to `scene`.
struct MapPart {
  perception::Scene scene;                     ///< primitives that go on outside are cut and have other ids
  std::vector<std::uint64_t> traces;           ///< of the decisions, by primitive; 0 for cut ones
  std::vector<char> is_open;                   ///< by primitive; openPrimitives()
  std::vector<rules::SemanticObject> objects;  ///< as far as they lie in the part, sorted by id
};

/// A larger share of a map's tiles is quicker to read as a whole.
inline constexpr double kMaxPartShare = 0.6;

/// The part in those of `tiles` that the map has. Absent when there are none, or when they are more than `max_share` of
/// its tiles. `reach_m` tells what is open. Cost: some milliseconds a tile.
std::optional<MapPart> partOfMap(const rdf::ReadTransaction& transaction, TileStages& stages,
                                 const perception::TileSet& tiles, double reach_m, double max_share = kMaxPartShare);

/// How large the part around a thing is to be.
struct PartSize {
  int rings = 1;      ///< of tiles around those of the thing
  double near_m = 0;  ///< with the tiles of the objects within this distance (tilesOfNearObjects())
  std::optional<std::size_t> most_cluxels = std::nullopt;  ///< no part when there are more
};
/// Whether tiles have more than `most` cluxels. Cost: reads the layers of tiles until that is known.
bool haveMoreCluxels(const rdf::ReadTransaction& transaction, const perception::TileSet& tiles, std::size_t most);

/// Where an object, or a primitive, is. Cost: of an object that of its tiles; of a primitive some microseconds a tile
/// of the map.
struct ThingPlace {
  std::set<ContentHash> primitives;
  perception::TileSet tiles;
};
ThingPlace placeOfObject(const rdf::ReadTransaction& transaction, const ContentHash& object);
ThingPlace placeOfPrimitive(const rdf::ReadTransaction& transaction, const ContentHash& primitive);

/// All tiles that hold primitives of a thing. These may be more than its own tiles: trees share a crown, which reaches
/// beyond the tiles of one of them. Cost: reads the layers of these tiles and of those next to them.
perception::TileSet tilesOfPrimitives(const rdf::ReadTransaction& transaction, const ThingPlace& thing);

/// The tiles of the objects that come within `near_m` of a thing, in plan; none of class-wide ones, nor of those that
/// reach over many tiles. `tiles`: tilesOfPrimitives(). Cost: reads the layers of these tiles and of those next to
/// them.
perception::TileSet tilesOfNearObjects(const rdf::ReadTransaction& transaction, const ThingPlace& thing,
                                       const perception::TileSet& tiles, double near_m);

/// How much of what is around a thing a part is to have.
struct LayersAround {
  std::uint32_t count = 0;  ///< of layers (rules::layersAround())
  double wider_m = 0;       ///< boxes tell layers only nearly: how much farther than `reach_m` they are taken to reach
};

/// The part with the first layers around a thing. Absent as for partOfMap(), and when there is no such thing.
std::optional<MapPart> partOfLayers(const rdf::ReadTransaction& transaction, TileStages& stages,
                                    const ThingPlace& thing, const rules::RuleSet& rules, double reach_m,
                                    const LayersAround& around);

/// The tiles with cluxels of an object, or of a primitive; empty when there is none. Cost: of a primitive some
/// microseconds a tile of the map.
perception::TileSet tilesOfObject(const rdf::ReadTransaction& transaction, const ContentHash& object);
perception::TileSet tilesOfPrimitive(const rdf::ReadTransaction& transaction, const ContentHash& primitive);

struct PrimitivePlace {
  ContentHash primitive;
  perception::TileKey tile;
};
/// The primitive at which an object is explained that reaches through the map: the widest one in the middle of the list
/// of its tiles. Absent when there is no such object. Cost: that of one tile.
std::optional<PrimitivePlace> samplePrimitiveOf(const rdf::ReadTransaction& transaction, const ContentHash& object);

}  // namespace cluxel::mapping
