// SPDX-License-Identifier: Apache-2.0
// Isomorphism by colour refinement, then by trying pairs of blank nodes that the colours do not tell apart.
#include "sparql/result_comparison_fixture.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <map>
#include <set>

#include "cluxel/knowledge/vocabulary.hpp"

namespace cluxel::test {

namespace {

using Colours = std::map<std::string, std::string>;   // blank node label -> colour

/// Numbers are written by value: 2, 02 and +2 are one decimal.
std::string literalKey(const Term& term) {
  static const std::set<std::string> numeric{vocabulary::xsd("integer"), vocabulary::xsd("decimal"),
                                             vocabulary::xsd("double"), vocabulary::xsd("float")};
  if (!numeric.contains(term.datatype)) return toNTriples(term);
  double value = 0;
  const char* begin = term.text.data() + (term.text.starts_with('+') ? 1 : 0);
  const char* end = term.text.data() + term.text.size();
  if (std::from_chars(begin, end, value).ptr != end || begin == end) return toNTriples(term);
  if (value == 0) value = 0;   // -0
  return std::to_string(value) + "/" + toNTriples(Term::real(value)) + "^^" + term.datatype;
}

std::string keyOf(const std::optional<Term>& term, const Colours& colours) {
  if (!term) return "UNDEF";
  if (term->kind == TermKind::BlankNode) return "_" + colours.at(term->text);
  return term->kind == TermKind::Literal ? literalKey(*term) : toNTriples(*term);
}

std::string keyOf(const Tuple& tuple, const Colours& colours) {
  std::string key;
  for (const auto& term : tuple) key += keyOf(term, colours) + '\x1F';
  return key;
}

std::vector<std::string> keysOf(const std::vector<Tuple>& tuples, const Colours& colours) {
  std::vector<std::string> keys;
  for (const Tuple& tuple : tuples) keys.push_back(keyOf(tuple, colours));
  std::sort(keys.begin(), keys.end());
  return keys;
}

Colours initialColours(const std::vector<Tuple>& tuples) {
  Colours colours;
  for (const Tuple& tuple : tuples)
    for (const auto& term : tuple)
      if (term && term->kind == TermKind::BlankNode) colours[term->text] = "b";
  return colours;
}

std::size_t countOf(const Colours& colours) {
  std::set<std::string> distinct;
  for (const auto& [label, colour] : colours) distinct.insert(colour);
  return distinct.size();
}

/// One round: a node's new colour is its old one and where it stands in which tuples.
Colours refinedOnce(const std::vector<Tuple>& tuples, const Colours& colours) {
  std::map<std::string, std::vector<std::string>> seen;
  for (const Tuple& tuple : tuples) {
    const std::string key = keyOf(tuple, colours);
    for (std::size_t i = 0; i < tuple.size(); ++i)
      if (tuple[i] && tuple[i]->kind == TermKind::BlankNode) seen[tuple[i]->text].push_back(std::to_string(i) + key);
  }
  Colours next;
  for (auto& [label, places] : seen) {
    std::sort(places.begin(), places.end());
    std::string text = colours.at(label);
    for (const std::string& place : places) text += place + '\x1E';
    next[label] = std::to_string(std::hash<std::string>()(text));
  }
  return next;
}

Colours refined(const std::vector<Tuple>& tuples, Colours colours) {
  for (std::size_t before = 0, now = countOf(colours); now != before || before == 0;) {
    if (colours.empty()) break;
    before = now;
    colours = refinedOnce(tuples, colours);
    now = countOf(colours);
  }
  return colours;
}

using Classes = std::map<std::string, std::vector<std::string>>;   // colour -> labels

Classes classesOf(const Colours& colours) {
  Classes classes;
  for (const auto& [label, colour] : colours) classes[colour].push_back(label);
  return classes;
}

/// When no tuple ties two blank nodes together that share their colours with others, nodes of one colour may stand for
/// each other.
bool areUntied(const std::vector<Tuple>& tuples, const Colours& colours, const Classes& classes) {
  return std::none_of(tuples.begin(), tuples.end(), [&](const Tuple& tuple) {
    std::set<std::string> ambiguous;
    for (const auto& term : tuple)
      if (term && term->kind == TermKind::BlankNode && classes.at(colours.at(term->text)).size() > 1) ambiguous.insert(term->text);
    return ambiguous.size() > 1;
  });
}

bool match(const std::vector<Tuple>& a, Colours colours_a, const std::vector<Tuple>& b, Colours colours_b, int depth) {
  colours_a = refined(a, std::move(colours_a));
  colours_b = refined(b, std::move(colours_b));
  if (keysOf(a, colours_a) != keysOf(b, colours_b)) return false;
  const Classes classes_a = classesOf(colours_a), classes_b = classesOf(colours_b);
  const std::vector<std::string>* smallest = nullptr;
  for (const auto& [colour, labels] : classes_a) {
    if (!classes_b.contains(colour) || classes_b.at(colour).size() != labels.size()) return false;
    if (labels.size() > 1 && (!smallest || labels.size() < smallest->size())) smallest = &labels;
  }
  if (!smallest || areUntied(a, colours_a, classes_a)) return true;
  const std::string colour = colours_a.at(smallest->front()), chosen = "chosen" + std::to_string(depth);
  colours_a[smallest->front()] = chosen;
  const std::vector<std::string>& candidates = classes_b.at(colour);
  return std::any_of(candidates.begin(), candidates.end(), [&](const std::string& label) {
    Colours colours = colours_b;
    colours[label] = chosen;
    return match(a, colours_a, b, std::move(colours), depth + 1);
  });
}

std::vector<Tuple> withRowNumbers(const std::vector<Tuple>& tuples) {
  std::vector<Tuple> numbered = tuples;
  for (std::size_t i = 0; i < numbered.size(); ++i) numbered[i].push_back(Term::integer(static_cast<std::int64_t>(i)));
  return numbered;
}

/// Columns by name, so that their order does not count.
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

/// Rows that only one side has, as far as ten of each go; blank nodes are written alike.
std::string shown(const std::vector<Tuple>& actual, const std::vector<Tuple>& expected) {
  std::map<std::string, int> surplus;
  const auto count = [&surplus](const std::vector<Tuple>& tuples, int by) {
    for (const Tuple& tuple : tuples) {
      std::string row;
      for (const auto& term : tuple) row += " " + (!term ? "UNDEF" : term->kind == TermKind::BlankNode ? "[]" : toNTriples(*term));
      surplus[row] += by;
    }
  };
  count(actual, 1);
  count(expected, -1);
  std::string text = std::to_string(actual.size()) + " rows, expected " + std::to_string(expected.size()) + "\n";
  int shown_rows = 0;
  for (const auto& [row, by] : surplus)
    if (by != 0 && ++shown_rows <= 20) text += (by > 0 ? "only got (" : "only expected (") + std::to_string(std::abs(by)) + "x):" + row + "\n";
  return text;
}

std::string namesOf(const QueryResult& result) {
  std::string text;
  for (const std::string& name : result.table.variables) text += " ?" + name;
  return text;
}

}  // namespace

bool isomorphic(const std::vector<Tuple>& a, const std::vector<Tuple>& b) {
  return a.size() == b.size() && match(a, initialColours(a), b, initialColours(b), 0);
}

bool isomorphicInOrder(const std::vector<Tuple>& a, const std::vector<Tuple>& b) {
  return isomorphic(withRowNumbers(a), withRowNumbers(b));
}

std::string difference(const QueryResult& actual, const QueryResult& expected, RowOrder order, Cardinality cardinality) {
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
