// SPDX-License-Identifier: Apache-2.0
// What a tile adds to objects that span the map: their facts are merged from these, without the cluxels of all tiles.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/facts/object_geometry.hpp"
#include "perception/segments/scene.hpp"
#include "perception/segments/summary_tile.hpp"
#include "rdf/file/environment.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// The cluxels of one part of a class-wide object in one tile.
struct WidePart {
  ContentHash object;
  std::string part_class;  ///< IRI, as ObjectPart::part_class
  ExtentSums sums;         ///< corners: their hull
  std::map<scan::ScanId, Sighting> seen;

  void add(const WidePart& other);
};

struct WideTile {
  perception::TileKey key;
  std::vector<WidePart> parts;  ///< ascending by object and part class
};

/// Of the tiles of a scene. `summaries`: of all its tiles.
std::vector<WideTile> wideTilesOf(const perception::Scene& scene,
                                  const std::map<perception::TileKey, perception::SummaryTile>& summaries,
                                  const std::vector<rules::SemanticObject>& objects);

/// Their parts merged in the order of tiles, ascending by object and part class.
std::vector<WidePart> mergedParts(const std::vector<WideTile>& tiles);

std::string toBytes(const WideTile& tile);
/// Throws Error (StoreUnavailable) when the bytes are damaged or of another kind.
WideTile wideTileFromBytes(std::string_view bytes);

/// Makes the map hold the blocks of these tiles and no others.
void storeWideTiles(rdf::WriteTransaction& transaction, const std::vector<WideTile>& wide);
/// The same for some tiles of the map: `tiles` without those of `wide` have no block.
void replaceWideTiles(rdf::WriteTransaction& transaction, const std::vector<WideTile>& wide,
                      const perception::TileSet& tiles);
/// Of all stored tiles, ascending. Cost: some microseconds a tile.
std::vector<WideTile> storedWideTiles(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
