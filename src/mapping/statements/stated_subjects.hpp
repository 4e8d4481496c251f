// SPDX-License-Identifier: Apache-2.0
// Turns what an update stated about an object into a statement that is anchored to the object's points.
#pragma once

#include <set>

#include "cluxel/progress.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Replaces quads of graph `operator` whose subject is an object of the map, or a thing or former object that such an
/// object continues: `object a CLASS` becomes a statement of class, any other property a stated fact. Quads about
/// objects that the map does not have stay as they are, and so do those that were there `before`
/// (quadsThatNameResources()): what they mean follows from when they were stated, not from what the map has become.
/// Notes how many there were, and names that change. Throws RefusedQuad for what requireStatable() and
/// requireNoWholeClass() refuse, and for classes of objects that the map does not have, which would contradict it once
/// it has them.
void anchorStatedObjects(rdf::WriteTransaction& transaction, const ParsedInputs& parsed,
                         const std::set<rdf::QuadIds>& before, ProgressSink& sink);

/// Notes which of the quads that were there `before` (quadsThatNameResources()) are still there and have an object for
/// their subject that the map knows by now: stating them again does nothing. Cost: that of the lineage of each subject.
void noteStandingQuads(const rdf::ReadTransaction& transaction, const std::set<rdf::QuadIds>& before,
                       ProgressSink& sink);

/// What changed since the graph `observed` was written.
struct NewStatements {
  std::vector<Statement> made;         ///< of graph `operator`, that `observed` does not tell of
  std::vector<ContentHash> withdrawn;  ///< that `observed` tells of, and graph `operator` no longer has
};
NewStatements newStatements(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
