// SPDX-License-Identifier: Apache-2.0
// Evaluates a query, writes the answer in the format of the expected one, reads it back and compares.
#include "sparql/w3c/w3c_case.hpp"

#include <map>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rdf/io/rdf_io.hpp"
#include "sparql/query_engine.hpp"
#include "sparql/results/result_writer.hpp"
#include "sparql/support/results_reader_fixture.hpp"
#include "sparql/syntax/parser.hpp"
#include "sparql/update_engine.hpp"
#include "sparql/w3c/w3c_expectation.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;

namespace {

void loadInto(QuadWriter& writer, const W3cFolder& folder, const W3cGraph& graph) {
  RdfSource source = readRdfSource(graph.file, Term::iri(graph.iri));
  source.base_iri = folder.iriOf(graph.file);
  loadRdf(source, writer);
}

}  // namespace

std::vector<Quad> graphIn(const W3cFolder& folder, const W3cGraph& graph) {
  RdfSource source = readRdfSource(graph.file, Term::iri(graph.iri));
  source.base_iri = folder.iriOf(graph.file);
  std::vector<Quad> quads;
  parseRdf(source, [&quads](const Quad& quad) { quads.push_back(quad); });
  return quads;
}

ast::Query parsedRequest(const W3cFolder& folder, const W3cCase& test, const std::string& text) {
  SparqlParseOptions options;
  options.file = test.request.filename().string();
  options.base_iri = folder.iriOf(test.request);
  return parseQuery(text, options);
}

std::vector<W3cGraph> datasetOf(const W3cFolder& folder, const W3cCase& test, const ast::Query& query) {
  std::vector<W3cGraph> dataset = test.data;
  if (!dataset.empty()) return dataset;
  for (const auto* graphs : {&query.dataset.default_graphs, &query.dataset.named_graphs})
    for (const Term& graph : *graphs) dataset.push_back({graph.text, folder.fileOf(graph.text)});
  return dataset;
}

Expected expectedOf(const W3cFolder& folder, const W3cCase& test, const ast::Query& query) {
  Expected expected;
  const bool sorted = !query.select.modifiers.order_by.empty();
  const std::string suffix = test.result->extension().string().substr(1);
  expected.format = resultFormatOf(suffix);
  const bool graph_file =
      !expected.format || *expected.format == ResultFormat::Turtle || *expected.format == ResultFormat::NTriples;
  if (!graph_file) {
    expected.result = readResults(readFile(*test.result), *expected.format, test.result->filename().string());
    if (sorted) expected.order = RowOrder::AsWritten;
    return expected;
  }
  expected.format.reset();
  std::vector<Quad> graph = graphIn(folder, {"", *test.result});
  if (query.form == ast::QueryForm::Construct || query.form == ast::QueryForm::Describe) {
    expected.result.kind = QueryResult::Kind::Graph;
    expected.result.graph = std::move(graph);
    return expected;
  }
  expected.result = resultsFromGraph(graph, test.result->filename().string());
  if (sorted) expected.order = RowOrder::AsWritten;
  return expected;
}

namespace {

/// CSV loses the kinds of terms, so our answer is written as CSV and read back before the comparison.
QueryResult throughFormat(const QueryResult& result, std::optional<ResultFormat> format) {
  if (!format || result.kind == QueryResult::Kind::Graph) return result;
  return readResults(writtenResult(result, *format), *format, "our own answer");
}

std::string evaluateQueryCase(const W3cFolder& folder, const W3cCase& test) {
  const std::string text = readFile(test.request);
  const ast::Query query = parsedRequest(folder, test, text);
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  for (const W3cGraph& graph : datasetOf(folder, test, query)) loadInto(writer, folder, graph);
  writer.flush();
  transaction.commit();
  const QuadReader reader(environment->read());
  QueryOptions options;
  options.default_graph = DefaultGraph::Unnamed;
  options.base_iri = folder.iriOf(test.request);
  options.source_name = test.request.filename().string();
  const QueryResult actual = evaluateQuery(reader, text, options);
  const Expected expected = expectedOf(folder, test, query);
  const Cardinality cardinality = test.lax_cardinality ? Cardinality::Reduced : Cardinality::Exact;
  return difference(throughFormat(actual, expected.format), expected.result, expected.order, cardinality);
}

std::map<std::string, std::vector<Quad>> graphsOf(const QuadReader& reader) {
  std::map<std::string, std::vector<Quad>> graphs;
  QuadCursor cursor = reader.scan({});
  for (QuadIds quad; cursor.next(quad);) {
    const Term graph = quad.g == kNoTerm ? Term::iri("") : reader.termOf(quad.g);
    graphs[graph.text].push_back({reader.termOf(quad.s), reader.termOf(quad.p), reader.termOf(quad.o), graph});
  }
  return graphs;
}

}  // namespace

std::string compareGraphs(const W3cFolder& folder, const W3cCase& test,
                          std::map<std::string, std::vector<Quad>> actual) {
  std::map<std::string, std::vector<Quad>> expected;
  for (const W3cGraph& graph : test.graphs_after)
    for (const Quad& quad : graphIn(folder, graph)) expected[graph.iri].push_back(quad);
  for (const auto& [iri, quads] : expected) actual[iri];
  for (const auto& [iri, quads] : actual) {
    const std::string difference = graphDifference(quads, expected[iri]);
    if (!difference.empty()) return "graph <" + iri + ">: " + difference;
  }
  return {};
}

namespace {

std::string evaluateUpdateCase(const W3cFolder& folder, const W3cCase& test) {
  const auto environment = Environment::temporary();
  WriteTransaction before = environment->write();
  QuadWriter writer(before);
  for (const W3cGraph& graph : test.data) loadInto(writer, folder, graph);
  writer.flush();
  before.commit();
  UpdateOptions options;
  options.query.default_graph = DefaultGraph::Unnamed;
  options.query.base_iri = folder.iriOf(test.request);
  options.any_graph_writable = true;
  WriteTransaction transaction = environment->write();
  runUpdate(transaction, readFile(test.request), options);
  transaction.commit();
  return compareGraphs(folder, test, graphsOf(QuadReader(environment->read())));
}

std::string checkSyntax(const W3cFolder& folder, const W3cCase& test) {
  SparqlParseOptions options;
  options.file = test.request.filename().string();
  options.base_iri = folder.iriOf(test.request);
  const bool update = test.kind == W3cKind::PositiveUpdate || test.kind == W3cKind::NegativeUpdate;
  const bool positive = test.kind == W3cKind::PositiveQuery || test.kind == W3cKind::PositiveUpdate;
  try {
    if (update)
      parseUpdate(readFile(test.request), options);
    else
      parseQuery(readFile(test.request), options);
  } catch (const InputError& error) {
    return positive ? error.what() : "";
  }
  return positive ? "" : "a faulty request was taken";
}

}  // namespace

std::string runCase(const W3cFolder& folder, const W3cCase& test) {
  try {
    if (test.kind == W3cKind::QueryEvaluation || test.kind == W3cKind::CsvResults)
      return evaluateQueryCase(folder, test);
    if (test.kind == W3cKind::UpdateEvaluation) return evaluateUpdateCase(folder, test);
    return checkSyntax(folder, test);
  } catch (const std::exception& error) {
    return std::string("error: ") + error.what();
  }
}

}  // namespace cluxel::test
