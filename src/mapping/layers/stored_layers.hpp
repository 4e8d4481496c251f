// SPDX-License-Identifier: Apache-2.0
// The layers above the stages in the map file: by tile and by object, so that a change writes what it reaches.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "mapping/layers/object_record.hpp"
#include "mapping/layers/tile_layer.hpp"
#include "rdf/file/environment.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

std::optional<TileLayer> storedLayer(const rdf::ReadTransaction& transaction, const perception::TileKey& tile);
std::optional<ObjectRecord> storedRecord(const rdf::ReadTransaction& transaction, const ContentHash& object);
/// The layers of all tiles, in the order of their keys. Cost: about 5 us a tile.
void forEachStoredLayer(const rdf::ReadTransaction& transaction, const std::function<void(const TileLayer&)>& visit);
/// The ids of all objects, ascending.
std::vector<ContentHash> storedObjectIds(const rdf::ReadTransaction& transaction);
/// The records of all objects, ascending by id.
void forEachRecord(const rdf::ReadTransaction& transaction,
                   const std::function<void(const ContentHash&, const ObjectRecord&)>& visit);

/// All objects of the map, sorted by id, with the numbers of primitives and cluxels that assembleScene() gives. Nothing
/// is stored of SemanticObject::decision. Throws Error (StoreUnavailable) when blocks do not belong together, or are of
/// another version. Cost: about 5 ns a cluxel, and 5 us a tile.
std::vector<rules::SemanticObject> storedObjects(const rdf::ReadTransaction& transaction);
/// The ids of all primitives, ascending as the scene has them, and the traces in the same order. Cost: about 5 us a
/// tile.
std::vector<ContentHash> storedPrimitives(const rdf::ReadTransaction& transaction);
std::vector<std::uint64_t> storedTraces(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
