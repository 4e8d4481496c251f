// SPDX-License-Identifier: Apache-2.0
// Types that SPARQL rules may not give to an object, because of what an operator stated about it.
#pragma once

#include <vector>

#include "rdf/ontology/staged_facts.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// The facts (object, rdf:type, class) that the applied statements rule out; sorted. Of an object that is stated not to
/// be of a class: this class and those below it. Of an object that is stated to be of a class: each class that the
/// ontology says to be disjoint (owl:disjointWith) with this class or with one above it, and those below. Follows from
/// graphs `ontology`, `operator` and `observed` and the closure of the subclasses. Cost: that of the statements.
std::vector<rdf::Triple> excludedTypes(const rdf::QuadReader& reader);

}  // namespace cluxel::mapping
