// SPDX-License-Identifier: Apache-2.0
// Loads small stores and formats their answers.
#include "sparql/support/store_fixture.hpp"

#include <algorithm>

#include "rdf/io/rdf_io.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;

const std::string kPrefixes =
    "PREFIX : <http://example.org/> PREFIX clx: <https://w3id.org/cluxel/ontology#> "
    "PREFIX xsd: <http://www.w3.org/2001/XMLSchema#> PREFIX rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> "
    "PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#> PREFIX geo: <http://www.opengis.net/ont/geosparql#> "
    "PREFIX geof: <http://www.opengis.net/def/function/geosparql/>\n";

namespace {

std::string shown(const Term* term) {
  if (term == nullptr) return "-";
  const std::string space = "http://example.org/";
  if (term->kind == TermKind::Iri && term->text.starts_with(space)) return ":" + term->text.substr(space.size());
  std::string text = toNTriples(*term);
  const std::string datatype = "^^<http://www.w3.org/2001/XMLSchema#";
  const std::size_t at = text.find(datatype);
  if (at != std::string::npos)
    text = text.substr(0, at) + "^^" + text.substr(at + datatype.size(), text.size() - at - datatype.size() - 1);
  return text;
}

}  // namespace

SmallStore::SmallStore(std::string_view turtle) : environment_(Environment::temporary()) {
  if (!turtle.empty()) load(turtle, "");
}

void SmallStore::load(std::string_view turtle, const std::string& graph_iri) {
  RdfSource source;
  std::string prefixes = kPrefixes;
  source.text = prefixes + std::string(turtle);
  source.name = "test.ttl";
  source.base_iri = "http://example.org/";
  source.graph = Term::iri(graph_iri);
  WriteTransaction transaction = environment_->write();
  QuadWriter writer(transaction);
  loadRdf(source, writer);
  writer.flush();
  transaction.commit();
}

void SmallStore::load(const std::vector<Quad>& quads) {
  WriteTransaction transaction = environment_->write();
  QuadWriter writer(transaction);
  for (const Quad& quad : quads) writer.add(quad);
  writer.flush();
  transaction.commit();
}

QueryResult SmallStore::ask(std::string_view query, const QueryOptions& options) const {
  const QuadReader snapshot = reader();
  return evaluateQuery(snapshot, kPrefixes + std::string(query), options);
}

std::vector<std::string> SmallStore::ordered(std::string_view query, const QueryOptions& options) const {
  const QueryResult result = ask(query, options);
  std::vector<std::string> lines;
  for (std::size_t row = 0; row < result.table.row_count; ++row) {
    std::string line;
    for (std::size_t column = 0; column < result.table.variables.size(); ++column) {
      line += (column > 0 ? " " : "") + shown(result.table.at(row, column));
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

std::vector<std::string> SmallStore::rows(std::string_view query, const QueryOptions& options) const {
  std::vector<std::string> lines = ordered(query, options);
  std::sort(lines.begin(), lines.end());
  return lines;
}

std::string SmallStore::value(const std::string& expression) const {
  const std::vector<std::string> lines = rows("SELECT (" + expression + " AS ?v) WHERE {}");
  return lines.size() == 1 ? lines[0] : "no row";
}

std::string explainQuery(const QuadReader& reader, std::string_view text, const QueryOptions& options) {
  PreparedQuery query(reader, text, options);
  query.evaluate();
  return query.explain();
}

}  // namespace cluxel::test
