// SPDX-License-Identifier: Apache-2.0
// What a test of the W3C suites reads and expects, for the engine and for the program.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sparql/query_engine.hpp"
#include "sparql/results/result_writer.hpp"
#include "sparql/support/result_comparison_fixture.hpp"
#include "sparql/syntax/ast.hpp"
#include "sparql/w3c/w3c_manifest.hpp"

namespace cluxel::test {

struct Expected {
  sparql::QueryResult result;
  RowOrder order = RowOrder::Any;
  std::optional<sparql::ResultFormat> format;  ///< absent: an RDF graph
};

sparql::ast::Query parsedRequest(const W3cFolder& folder, const W3cCase& test, const std::string& text);
/// The graphs of the test, else those that the query names with FROM, under their IRIs.
std::vector<W3cGraph> datasetOf(const W3cFolder& folder, const W3cCase& test, const sparql::ast::Query& query);
std::vector<Quad> graphIn(const W3cFolder& folder, const W3cGraph& graph);
Expected expectedOf(const W3cFolder& folder, const W3cCase& test, const sparql::ast::Query& query);
/// Compares graph by graph, because blank nodes of different files are always different.
std::string compareGraphs(const W3cFolder& folder, const W3cCase& test,
                          std::map<std::string, std::vector<Quad>> actual);

}  // namespace cluxel::test
