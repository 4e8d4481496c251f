// SPDX-License-Identifier: Apache-2.0
// What may be stated about objects.
#pragma once

#include <string>

#include "cluxel/progress.hpp"
#include "mapping/statements/statement.hpp"
#include "rdf/file/environment.hpp"
#include "rules/language/class_catalogue.hpp"

namespace cluxel::mapping {

/// Whether the ontology knows the class as one of objects: no part, place or cluxel, and not just any object.
bool isClassOfObjects(const std::string& iri, const rules::ClassCatalogue& classes);

/// "<IRI> is no class of objects: it is not below clx:Object"
std::string noClassOfObjects(const std::string& iri);

/// Throws Error (InvalidArgument) for a property that the map computes, such as clx:height.
void requireStatable(const std::string& property);

/// The same for a fact about such a property, a fact whose value is a blank node or no UTF-8, "is" a class that is none
/// of objects (a part, a place, a cluxel), "is" or "is not" one that says no more than that it is an object, and a
/// region without area or with a corner farther than 1000 km from its scan. Throws Error (NotFound) for a class that
/// the ontology does not know.
void requireStatable(const Statement& statement, const rules::ClassCatalogue& classes);

/// As requireStatable(), but a statement of a class that the ontology does not know is noted and kept: such as one of a
/// map that had another ontology. It has no effect until an ontology knows the class.
void requireStatableOrDormant(const Statement& statement, const rules::ClassCatalogue& classes, ProgressSink& sink);

/// For statements that a map may have had: with another ontology, or from an earlier program. As
/// requireStatableOrDormant(), but one of a class that is none of objects, or of a property that the map computes, is
/// noted and kept, too: a map that has it keeps it through every change, and a build must give the same map.
void requireStatableOrKept(const Statement& statement, const rules::ClassCatalogue& classes, ProgressSink& sink);

/// Throws Error (InvalidArgument) for the statement that something is of a class of which the map has one object over
/// all of it, as the ground.
void requireNoWholeClass(const rdf::ReadTransaction& transaction, const Statement& statement);

}  // namespace cluxel::mapping
