// SPDX-License-Identifier: Apache-2.0
// Converts answers to multisets of tuples and compares them up to the names of blank nodes.
#include "sparql/support/result_comparison_fixture.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include "rdf/vocabulary.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;

namespace {

std::vector<Tuple> withRowNumbers(const std::vector<Tuple>& tuples) {
  std::vector<Tuple> numbered = tuples;
  for (std::size_t i = 0; i < numbered.size(); ++i) numbered[i].push_back(Term::integer(static_cast<std::int64_t>(i)));
  return numbered;
}

/// Columns sorted by name, so that their order does not matter.
std::vector<Tuple> tuplesOf(const ResultTable& table) {
  std::map<std::string, std::size_t> columns;
  for (std::size_t i = 0; i < table.variables.size(); ++i) columns[table.variables[i]] = i;
  std::vector<Tuple> tuples(table.row_count);
  for (std::size_t row = 0; row < table.row_count; ++row) {
    for (const auto& [name, column] : columns) {
      const Term* term = table.at(row, column);
      tuples[row].push_back(term ? std::optional<Term>(*term) : std::nullopt);
    }
  }
  return tuples;
}

std::vector<Tuple> tuplesOf(const std::vector<Quad>& quads) {
  std::vector<Tuple> tuples;
  for (const Quad& quad : quads) tuples.push_back({quad.subject, quad.predicate, quad.object, quad.graph});
  return tuples;
}

std::vector<Tuple> distinct(std::vector<Tuple> tuples) {
  std::sort(tuples.begin(), tuples.end());
  tuples.erase(std::unique(tuples.begin(), tuples.end()), tuples.end());
  return tuples;
}

bool withinReduced(const std::vector<Tuple>& actual, const std::vector<Tuple>& expected) {
  return isomorphic(distinct(actual), distinct(expected)) && actual.size() <= expected.size();
}

/// At most ten rows that only one side has; blank nodes are written without their names.
std::string shown(const std::vector<Tuple>& actual, const std::vector<Tuple>& expected) {
  std::map<std::string, int> surplus;
  const auto count = [&surplus](const std::vector<Tuple>& tuples, int by) {
    for (const Tuple& tuple : tuples) {
      std::string row;
      for (const auto& term : tuple)
        row += " " + (!term ? "UNDEF" : term->kind == TermKind::BlankNode ? "[]" : toNTriples(*term));
      surplus[row] += by;
    }
  };
  count(actual, 1);
  count(expected, -1);
  std::string text = std::to_string(actual.size()) + " rows, expected " + std::to_string(expected.size()) + "\n";
  int shown_rows = 0;
  for (const auto& [row, by] : surplus)
    if (by != 0 && ++shown_rows <= 20)
      text += (by > 0 ? "only got (" : "only expected (") + std::to_string(std::abs(by)) + "x):" + row + "\n";
  return text;
}

std::string namesOf(const QueryResult& result) {
  std::string text;
  for (const std::string& name : result.table.variables) text += " ?" + name;
  return text;
}

}  // namespace

bool isomorphicInOrder(const std::vector<Tuple>& a, const std::vector<Tuple>& b) {
  return isomorphic(withRowNumbers(a), withRowNumbers(b));
}

std::string difference(const QueryResult& actual, const QueryResult& expected, RowOrder order,
                       Cardinality cardinality) {
  if (actual.kind != expected.kind) return "another kind of answer";
  if (actual.kind == QueryResult::Kind::Boolean)
    return actual.boolean == expected.boolean ? "" : actual.boolean ? "got true" : "got false";
  if (actual.kind == QueryResult::Kind::Graph) return graphDifference(actual.graph, expected.graph);
  const std::set<std::string> names_a(actual.table.variables.begin(), actual.table.variables.end());
  const std::set<std::string> names_b(expected.table.variables.begin(), expected.table.variables.end());
  const std::vector<Tuple> a = tuplesOf(actual.table), b = tuplesOf(expected.table);
  const bool same = names_a == names_b && (cardinality == Cardinality::Reduced ? withinReduced(a, b)
                                           : order == RowOrder::AsWritten      ? isomorphicInOrder(a, b)
                                                                               : isomorphic(a, b));
  return same ? "" : "columns" + namesOf(actual) + ", expected" + namesOf(expected) + "\n" + shown(a, b);
}

std::string graphDifference(const std::vector<Quad>& actual, const std::vector<Quad>& expected) {
  if (isomorphic(distinct(tuplesOf(actual)), distinct(tuplesOf(expected)))) return {};
  return shown(tuplesOf(actual), tuplesOf(expected));
}

}  // namespace cluxel::test
