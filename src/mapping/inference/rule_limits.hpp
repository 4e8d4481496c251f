// SPDX-License-Identifier: Apache-2.0
// Keeps rules from finding what rules have made only because they may look at everything.
#pragma once

#include "mapping/map_inputs.hpp"
#include "sparql/syntax/ast.hpp"

namespace cluxel::mapping {

/// Whether the path holds between a term and itself without a step.
bool mayHaveNoStep(const sparql::ast::Path& path);

/// Throws InputError for such a path between two variables that nothing else binds: it holds for every term of the map,
/// also for those by which derivations are described. `query`: with sequences of paths taken apart.
void refuseUnboundPaths(const sparql::ast::Query& query, const NamedText& rule);

/// Leaves out descriptions of derivations (clx:Derivation) where a pattern may hold for any fact: where its property is
/// a variable, or a path walks all properties but some. A rule would find what it made itself, without end.
void hideDerivations(sparql::ast::Query& query);

}  // namespace cluxel::mapping
