// SPDX-License-Identifier: Apache-2.0
// Objects of a map as values, read from its observed facts.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/object.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/store/quad_store.hpp"
#include "tasks/named_class.hpp"

namespace cluxel {

/// All objects with their parts, sorted by IRI. Cost O(objects).
std::vector<Object> objectsOf(const rdf::QuadReader& reader);
/// Those of a class, written as for classNamed(), as objectsOfClass() tells. Throws Error (NotFound) as that does, and
/// as requireClassOfObjects().
std::vector<Object> objectsOf(const rdf::QuadReader& reader, std::string_view class_name,
                              const std::function<tasks::Namespaces()>& namespaces);

/// Of objects that are sorted by IRI: those that are of a class, as tasks::objectsOfClass() tells from `reader`.
std::vector<const Object*> objectsOfClass(const std::vector<Object>& objects, const rdf::QuadReader& reader,
                                          const std::string& class_iri);

}  // namespace cluxel
