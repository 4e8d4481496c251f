// SPDX-License-Identifier: Apache-2.0
// Asks both engines and compares their answers.
#include "sparql/support/differential_fixture.hpp"

#include <array>
#include <charconv>
#include <cstdio>
#include <set>

#include "cluxel/error.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/support/result_comparison_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;

namespace {

/// Rounds numbers to ten digits, so that the order of summation and the precision of divisions do not matter.
Term rounded(const Term& term) {
  const bool number = term.datatype == vocabulary::xsd("double") || term.datatype == vocabulary::xsd("decimal") ||
                      term.datatype == vocabulary::xsd("float");
  double value = 0;
  const char* end = term.text.data() + term.text.size();
  if (!number || std::from_chars(term.text.data(), end, value).ptr != end) return term;
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.10g", value == 0 ? 0.0 : value);
  return Term::literal(text.data(), term.datatype);
}

QueryResult rounded(QueryResult result) {
  for (Term& term : result.table.terms) term = rounded(term);
  for (Quad& quad : result.graph) quad.object = rounded(quad.object);
  return result;
}

}  // namespace

std::shared_ptr<Environment> storeOf(const std::vector<Quad>& quads) {
  auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  for (const Quad& quad : quads) writer.add(quad);
  writer.flush();
  transaction.commit();
  return environment;
}

EngineAnswer askCluxel(const QuadReader& reader, const std::string& text, bool union_graph,
                       const std::vector<Binding>& bindings) {
  QueryOptions options;
  options.default_graph = union_graph ? DefaultGraph::UnionButHistory : DefaultGraph::Unnamed;
  options.budget.deadline = std::chrono::seconds(20);
  std::vector<std::string> parameters;
  for (const Binding& binding : bindings) parameters.push_back(binding.first);
  try {
    return {PreparedQuery(reader, text, options, parameters).evaluate(bindings), {}};
  } catch (const Error& error) {
    return {std::nullopt, error.what()};
  }
}

std::vector<Quad> withUnionAsDefault(const std::vector<Quad>& quads) {
  std::set<Quad> merged;
  for (const Quad& quad : quads) {
    if (quad.graph.text != vocabulary::kGraphHistory)
      merged.insert({quad.subject, quad.predicate, quad.object, Term::iri("")});
    if (!quad.graph.text.empty()) merged.insert(quad);
  }
  return {merged.begin(), merged.end()};
}

std::string differenceOf(const EngineAnswer& ours, const EngineAnswer& theirs) {
  if (!ours.result && !theirs.result) return {};
  if (!ours.result) return "Cluxel refused: " + ours.error;
  if (!theirs.result) return "oxigraph refused: " + theirs.error;
  return difference(rounded(*ours.result), rounded(*theirs.result));
}

}  // namespace cluxel::test
