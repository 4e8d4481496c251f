// SPDX-License-Identifier: Apache-2.0
// The tiles that a window will need beside those around a change, told from what the map knew of them.
#pragma once

#include <set>

#include "perception/tile.hpp"
#include "rdf/file/environment.hpp"
#include "rules/language/rule_set.hpp"

namespace cluxel::mapping {

/// The objects of the classes that the strata of lone seeds make (rules::strataOfLoneSeeds()).
std::set<ContentHash> objectsOfLoneSeeds(const rules::RuleSet& rules);

/// The tiles of `map` within reach of the first layers around changed tiles, without what these objects took. Layers
/// are estimated from stored boxes; everything in a changed tile counts as changed. A window needs most of these tiles
/// and hardly any others. Cost: about 10 us for each tile read.
perception::TileSet likelyTiles(const rdf::ReadTransaction& transaction, const perception::TileSet& map,
                                const perception::TileSet& changed, const std::set<ContentHash>& lone_objects,
                                double reach_m, std::uint32_t layers);

/// The map's tiles within reach of the first layers around some primitives, which have cluxels in `tiles`, and these.
perception::TileSet tilesAround(const rdf::ReadTransaction& transaction, const std::set<ContentHash>& primitives,
                                const perception::TileSet& tiles, const std::set<ContentHash>& lone_objects,
                                double reach_m, std::uint32_t layers);

}  // namespace cluxel::mapping
