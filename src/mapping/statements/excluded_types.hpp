// SPDX-License-Identifier: Apache-2.0
// Types that SPARQL rules may not give to an object, because of what an operator stated about it.
#pragma once

#include <string>
#include <vector>

#include "mapping/statements/statement.hpp"
#include "rdf/ontology/staged_facts.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// The facts (object, rdf:type, class) that the applied statements rule out; sorted. Of an object that is stated not to
/// be of a class: this class and those below it. Of an object that is stated to be of a class: each class that the
/// ontology says to be disjoint (owl:disjointWith) with this class or with one above it, and those below. Follows from
/// graphs `ontology`, `operator` and `observed` and the closure of the subclasses. Cost: for each kind and class that
/// is stated, its classes above times those disjoint with them times those below these; for each statement, what it
/// rules out.
std::vector<rdf::Triple> excludedTypes(const rdf::QuadReader& reader);

/// The IRIs of the applied statements about the object that rule out the class; sorted.
std::vector<std::string> statementsAgainst(const rdf::QuadReader& reader, const std::string& object_iri,
                                           const std::string& class_iri);

/// Whether the statement, once it is applied, rules out that rules give its object the class. False of a statement that
/// is about no class.
bool rulesOut(const rdf::QuadReader& reader, const Statement& statement, const std::string& class_iri);

}  // namespace cluxel::mapping
