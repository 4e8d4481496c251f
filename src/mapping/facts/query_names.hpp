// SPDX-License-Identifier: Apache-2.0
// Names in queries that cannot match anything: classes and properties that the ontology does not know, variables of a
// FILTER that nothing binds, and the graph of the history.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cluxel/error.hpp"

#include "rdf/ontology/ontology.hpp"
#include "sparql/syntax/ast.hpp"

namespace cluxel::mapping {

struct QueryNameFault {
  sparql::ast::SourceOffset at = 0;  ///< in Query::text
  std::string message;               ///< with "did you mean"
};

/// `bound`: variables that have a value before the query runs. Only names of Cluxel's own vocabulary are looked up. In
/// the order of the text.
std::vector<QueryNameFault> faultsOfNames(const sparql::ast::Query& query, const rdf::OntologyView& ontology,
                                          std::span<const std::string> bound = {});

/// The classes of which the query looks for things (`?x a clx:Tree`), in groups of every kind; each once, sorted.
std::vector<std::string> classesAskedFor(const sparql::ast::Query& query);

/// Where the query of a rule names the graph of the history, which rules do not see: what is built and when may not
/// change what follows from the scans. A variable graph (GRAPH ?g) goes through the others.
std::optional<QueryNameFault> historyNamedIn(const sparql::ast::Query& query);

/// The faults of a SPARQL rule with their places. Throws InputError when it cannot be parsed.
std::vector<Diagnostic> checkRuleNames(const std::string& name, const std::string& text,
                                       const rdf::OntologyView& ontology);
/// Line and column of a byte of the query's text.
SourceLocation locationIn(const sparql::ast::Query& query, const std::string& name, sparql::ast::SourceOffset at);

}  // namespace cluxel::mapping
