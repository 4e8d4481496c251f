// SPDX-License-Identifier: Apache-2.0
// The even ground of tiles in which things stood that are gone, kept in the map: ways follow from it there.
#pragma once

#include <optional>
#include <string_view>

#include "mapping/map_inputs.hpp"
#include "perception/crf/label_model.hpp"
#include "perception/tile.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Whether rays saw through the place of an object after it was gone (clx:seenThrough), or the map has a freed tile.
bool mayHaveFreedTiles(const rdf::ReadTransaction& transaction);

/// The even ground of a tile without gone things, as of perception::toBytes(); absent where the output of the stage
/// counts. Valid as long as a block.
std::optional<std::string_view> freedTile(const rdf::ReadTransaction& transaction, const perception::TileKey& tile);

/// Brings freed tiles up to date. Objects, layers of tiles and presence must be those of the commit to come; `changed`
/// are the tiles of which an output of a stage changed since the last call. A freed tile is a function of the outputs
/// of its ring and of the gone objects that come near it. Returns the tiles of which the even ground that counts
/// changed. Cost: 1 us an object, and some 20 ms for each tile that is computed.
perception::TileSet updateFreedTiles(rdf::WriteTransaction& transaction, const perception::LabelModel& model,
                                     const MapParams& params, const perception::TileSet& changed, unsigned threads);

/// To be called before each other commit that changes the map and leaves objects and outputs as they are. A commit
/// without it makes the next change compute all freed tiles.
void keepFreedTiles(rdf::WriteTransaction& transaction);

/// Ways then follow from what was measured alone, until the next update. Returns as updateFreedTiles().
perception::TileSet eraseFreedTiles(rdf::WriteTransaction& transaction);

/// Copies the freed tiles of another map. False when they are not those of its objects, because an earlier program has
/// changed it: then none is copied, and its ways are not to be taken.
bool copyFreedTiles(rdf::WriteTransaction& transaction, const rdf::ReadTransaction& other,
                    const perception::TileSet& tiles);

}  // namespace cluxel::mapping
