// SPDX-License-Identifier: Apache-2.0
// The part of a map that lies in some tiles, read without the rest of the map.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mapping/build/tile_stages.hpp"
#include "perception/segments/scene.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// All numbers refer to `scene`.
struct MapPart {
  perception::Scene scene;                     ///< primitives that go on outside are cut and have other ids
  std::vector<std::uint64_t> traces;           ///< of the decisions, by primitive; 0 for cut ones
  std::vector<rules::SemanticObject> objects;  ///< as far as they lie in the part, sorted by id
};

/// The part in those of `tiles` that the map has. Absent when there are none, or when they are most of the map, which
/// is then quicker to read as a whole. Cost: some milliseconds a tile.
std::optional<MapPart> partOfMap(const rdf::ReadTransaction& transaction, TileStages& stages,
                                 const perception::TileSet& tiles);

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
