// SPDX-License-Identifier: Apache-2.0
// Objects of a map as values, read from its observed facts.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cluxel/object.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel {

/// All objects with their parts, sorted by IRI. Cost O(objects).
std::vector<Object> objectsOf(const rdf::QuadReader& reader);
/// Those of a class or its subclasses. Throws Error (NotFound) for a class that the ontology does not know.
std::vector<Object> objectsOf(const rdf::QuadReader& reader, std::string_view class_name);

}  // namespace cluxel
