// SPDX-License-Identifier: Apache-2.0
// The stages of ways over a map's tiles: outputs are kept in the map file, and only what a change reaches is computed.
#pragma once

#include "mapping/ways/ways.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Brings both stages up to date after the even ground of some tiles changed, came or went. Also computes tiles that
/// lack an output. `fresh`: even ground that is at hand; the rest is read. Returns the tiles of which what they
/// contribute to ways changed, came or went. Memory: some 30 MB a thread.
perception::TileSet updateWayTiles(rdf::WriteTransaction& transaction, const perception::TileSet& changed_even,
                                   const std::map<perception::TileKey, perception::EvenTile>& fresh, unsigned threads);

/// The ways of all tiles of a map, from their stored outputs.
WayGraph storedWays(const rdf::ReadTransaction& transaction);
/// The ways that follow from all points, those of gone things too: what rules see that ask the map, because objects are
/// not known then. Cost: about 1 ms a tile.
WayGraph measuredWays(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
