// SPDX-License-Identifier: Apache-2.0
// Turns what an update stated about an object into a statement that is anchored to the object's points.
#pragma once

#include "cluxel/progress.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Whether the subject is an IRI of an object or a thing, be it known or not.
bool namesObject(const Term& subject);

/// Replaces quads of graph `operator` whose subject is an object of the map, or a thing or former object that such an
/// object continues: `object a CLASS` becomes a statement of class, any other property a stated fact. Quads about
/// objects that the map never had stay as they are. Notes how many there were. Throws Error: InvalidArgument for a
/// property that the map computes itself, or a malformed statement; NotFound for a class that the ontology does not
/// know.
void anchorStatedObjects(rdf::WriteTransaction& transaction, const ParsedInputs& parsed, ProgressSink& sink);

/// What changed since the graph `observed` was written.
struct NewStatements {
  std::vector<Statement> made;         ///< of graph `operator`, that `observed` does not tell of
  std::vector<ContentHash> withdrawn;  ///< that `observed` tells of, and graph `operator` no longer has
};
NewStatements newStatements(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
