// SPDX-License-Identifier: Apache-2.0
// Operator statements in the semantic layer: applied once the rules' result is known, told as facts, and stored.
#pragma once

#include <vector>

#include "mapping/facts/fact_sink.hpp"
#include "mapping/statements/applied_statements.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Applies the statements of graph `operator` to the rules' objects. Nothing is read where there are none.
AppliedStatements appliedStatements(const rdf::ReadTransaction& transaction, TileStages& stages,
                                    const perception::ThinParams& thin, const std::vector<Cloud>& clouds,
                                    const perception::Scene& scene, const rules::ClassCatalogue& classes,
                                    std::vector<rules::SemanticObject> by_rules);

/// Which object each statement applies to, what the rules say of it, and the stated properties of objects.
void addStatementFacts(const std::vector<StatementOutcome>& outcomes, FactSink& facts);

/// Whether the map has none of the scans that a statement is anchored to.
bool lacksScans(const rdf::QuadReader& quads, const Statement& statement);
/// What the facts of the map tell of all its statements.
std::vector<StatementOutcome> toldOutcomes(const rdf::QuadReader& quads);

}  // namespace cluxel::mapping
