// SPDX-License-Identifier: Apache-2.0
// Which objects are of a class: one answer for all tasks, and the same as that of a query.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/content_hash.hpp"
#include "mapping/map_reader.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::tasks {

/// The objects of which the graph says so, as the query `SELECT DISTINCT ?object { ?object a <class> }` finds them:
/// observed, stated, and what follows by the ontology and by SPARQL rules. Ascending. A rule may name an object that
/// the map does not hold; it is among them. Cost and memory: those of the things of the class.
std::vector<ContentHash> objectsOfClass(const rdf::QuadReader& quads, const std::string& class_iri);

/// Whether the object is among them. Cost: a look-up.
bool isOfClass(const rdf::QuadReader& quads, const ContentHash& object, const std::string& class_iri);

/// Those that the map holds, by their numbers in MapReader::objects(). Ascending.
std::vector<std::uint32_t> objectsOfClass(const mapping::MapReader& map, const std::string& class_iri);

/// Whether there is one of these. Cost: that of the things of the class up to the first object.
bool hasObjectOfClass(const mapping::MapReader& map, const std::string& class_iri);

}  // namespace cluxel::tasks
