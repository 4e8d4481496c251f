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

/// The map's tiles next to those of a window that lie within reach of something in it, other than of these objects. A
/// window asks for hardly any others, and for most of these: the first layers around a change reach farther than a ring
/// of tiles.
perception::TileSet likelyTiles(const rdf::ReadTransaction& transaction, const perception::TileSet& window,
                                const std::set<ContentHash>& lone_objects, double reach_m);

}  // namespace cluxel::mapping
