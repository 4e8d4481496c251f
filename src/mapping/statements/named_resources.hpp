// SPDX-License-Identifier: Apache-2.0
// Names of the map's resources in what people state: many of them change with the members.
#pragma once

#include <set>

#include "cluxel/progress.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// Whether the subject is an IRI of an object or a thing, be it known or not.
bool namesObject(const Term& subject);

/// The quads of graph `operator` of which subject or value is an IRI of an object, a thing, a part, a primitive or an
/// observation. Cost: one reading of the graph.
std::set<rdf::QuadIds> quadsThatNameResources(const rdf::ReadTransaction& transaction);

/// Notes subjects that are parts, primitives or observations, and values that are these or objects: what is stated does
/// not follow them when their names change. Names for a value that is an object its thing, which can be stated instead.
void noteNamesThatChange(const rdf::ReadTransaction& transaction, const std::set<rdf::QuadIds>& stated,
                         ProgressSink& sink);

}  // namespace cluxel::mapping
