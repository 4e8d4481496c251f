// SPDX-License-Identifier: Apache-2.0
// The layers above the stages in the map file: by tile and by object, so that a change writes what it reaches.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mapping/layers/object_record.hpp"
#include "mapping/layers/tile_layer.hpp"
#include "rdf/file/environment.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

std::optional<TileLayer> storedLayer(const rdf::ReadTransaction& transaction, const perception::TileKey& tile);
std::optional<ObjectRecord> storedRecord(const rdf::ReadTransaction& transaction, const ContentHash& object);

/// All objects of the map, sorted by id, with the numbers of primitives and cluxels that assembleScene() gives. Nothing
/// is stored of SemanticObject::decision. Throws Error (StoreUnavailable) when blocks do not belong together, or are of
/// another version. Cost: about 5 ns a cluxel, and 5 us a tile.
std::vector<rules::SemanticObject> storedObjects(const rdf::ReadTransaction& transaction);
/// The traces of all primitives, in the order of the scene's. Cost: about 5 us a tile.
std::vector<std::uint64_t> storedTraces(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
