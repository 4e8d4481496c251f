// SPDX-License-Identifier: Apache-2.0
// Isomorphism by colour refinement for each connected part; nodes of equal colour are matched by backtracking.
#include "sparql/support/isomorphism_fixture.hpp"

#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include "rdf/vocabulary.hpp"

namespace cluxel::test {

using namespace rdf;

namespace {

using Key = std::uint64_t;

/// One place of a tuple: the number of a blank node, or the hash of another term.
struct Cell {
  bool is_blank = false;
  std::size_t node = 0;
  Key key = 0;
};
using Row = std::vector<Cell>;
using Colours = std::vector<Key>;  // by the number of the blank node

struct Coded {
  std::vector<Row> rows;
  std::size_t nodes = 0;
};

Key mixed(Key seed, Key value) {
  seed ^= value + 0x9e37'79b9'7f4a'7c15ULL + (seed << 6U) + (seed >> 2U);
  seed *= 0xff51'afd7'ed55'8ccdULL;
  return seed ^ (seed >> 33U);
}

/// Numbers are normalised: 2, 02 and +2 are the same decimal.
std::string literalKey(const Term& term) {
  static const std::set<std::string> numeric{vocabulary::xsd("integer"), vocabulary::xsd("decimal"),
                                             vocabulary::xsd("double"), vocabulary::xsd("float")};
  if (!numeric.contains(term.datatype)) return toNTriples(term);
  double value = 0;
  const char* begin = term.text.data() + (term.text.starts_with('+') ? 1 : 0);
  const char* end = term.text.data() + term.text.size();
  if (std::from_chars(begin, end, value).ptr != end || begin == end) return toNTriples(term);
  if (value == 0) value = 0;  // -0
  return std::to_string(value) + "/" + toNTriples(Term::real(value)) + "^^" + term.datatype;
}

Coded coded(const std::vector<Tuple>& tuples) {
  Coded result;
  std::map<std::string, std::size_t> numbers;
  for (const Tuple& tuple : tuples) {
    Row row;
    for (const auto& term : tuple) {
      if (term && term->kind == TermKind::BlankNode) {
        row.push_back({true, numbers.emplace(term->text, numbers.size()).first->second, 0});
        continue;
      }
      const std::string text = !term                             ? "UNDEF"
                               : term->kind == TermKind::Literal ? literalKey(*term)
                                                                 : toNTriples(*term);
      row.push_back({false, 0, std::hash<std::string>()(text)});
    }
    result.rows.push_back(std::move(row));
  }
  result.nodes = numbers.size();
  return result;
}

Key keyOf(const Row& row, const Colours& colours) {
  Key key = row.size();
  for (const Cell& cell : row) key = mixed(key, cell.is_blank ? mixed(1, colours[cell.node]) : mixed(2, cell.key));
  return key;
}

std::vector<Key> keysOf(const std::vector<Row>& rows, const Colours& colours) {
  std::vector<Key> keys;
  for (const Row& row : rows) keys.push_back(keyOf(row, colours));
  std::sort(keys.begin(), keys.end());
  return keys;
}

std::size_t countOf(const Colours& colours) {
  return std::set<Key>(colours.begin(), colours.end()).size();
}

/// One round of refinement: a node's new colour is a hash of its old colour and of its places in rows.
Colours refinedOnce(const std::vector<Row>& rows, const Colours& colours) {
  std::vector<std::vector<Key>> seen(colours.size());
  for (const Row& row : rows) {
    const Key key = keyOf(row, colours);
    for (std::size_t i = 0; i < row.size(); ++i)
      if (row[i].is_blank) seen[row[i].node].push_back(mixed(i, key));
  }
  Colours next = colours;
  for (std::size_t node = 0; node < colours.size(); ++node) {
    std::sort(seen[node].begin(), seen[node].end());
    for (const Key place : seen[node]) next[node] = mixed(next[node], place);
  }
  return next;
}

Colours refined(const std::vector<Row>& rows, Colours colours) {
  if (colours.empty()) return colours;
  for (std::size_t before = 0, now = countOf(colours); now != before;) {
    before = now;
    colours = refinedOnce(rows, colours);
    now = countOf(colours);
  }
  return refinedOnce(rows, colours);
}

/// Rows connected by blank nodes, with renumbered nodes.
struct Part {
  std::vector<Row> rows;
  Colours colours;

  bool isTold() const { return countOf(colours) == colours.size(); }
};

std::size_t rootOf(std::vector<std::size_t>& parent, std::size_t node) {
  while (parent[node] != node) node = parent[node] = parent[parent[node]];
  return node;
}

std::vector<Part> partsOf(const Coded& coded, const Colours& colours) {
  std::vector<std::size_t> parent(coded.nodes);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> node_of_row;
  for (const Row& row : coded.rows) {
    std::size_t first = kNone;
    for (const Cell& cell : row) {
      if (!cell.is_blank) continue;
      if (first == kNone)
        first = cell.node;
      else
        parent[rootOf(parent, cell.node)] = rootOf(parent, first);
    }
    node_of_row.push_back(first);
  }
  std::map<std::size_t, Part> parts;
  std::vector<std::size_t> number(coded.nodes, kNone);
  for (std::size_t i = 0; i < coded.rows.size(); ++i) {
    if (node_of_row[i] == kNone) continue;
    Part& part = parts[rootOf(parent, node_of_row[i])];
    Row row = coded.rows[i];
    for (Cell& cell : row) {
      if (!cell.is_blank) continue;
      if (number[cell.node] == kNone) {
        number[cell.node] = part.colours.size();
        part.colours.push_back(colours[cell.node]);
      }
      cell.node = number[cell.node];
    }
    part.rows.push_back(std::move(row));
  }
  std::vector<Part> list;
  for (auto& [root, part] : parts) list.push_back(std::move(part));
  return list;
}

using Classes = std::map<Key, std::vector<std::size_t>>;  // colour -> nodes

Classes classesOf(const Colours& colours) {
  Classes classes;
  for (std::size_t node = 0; node < colours.size(); ++node) classes[colours[node]].push_back(node);
  return classes;
}

/// True when no row connects two nodes whose colours are shared with other nodes; nodes of one colour are then
/// interchangeable.
bool areUntied(const std::vector<Row>& rows, const Colours& colours, const Classes& classes) {
  return std::none_of(rows.begin(), rows.end(), [&](const Row& row) {
    std::set<std::size_t> ambiguous;
    for (const Cell& cell : row)
      if (cell.is_blank && classes.at(colours[cell.node]).size() > 1) ambiguous.insert(cell.node);
    return ambiguous.size() > 1;
  });
}

/// Refines the colours of both sides. Where nodes share a colour, one of `a` is individualised and every candidate of
/// `b` is tried.
bool match(const std::vector<Row>& a, Colours colours_a, const std::vector<Row>& b, Colours colours_b, Key depth) {
  colours_a = refined(a, std::move(colours_a));
  colours_b = refined(b, std::move(colours_b));
  if (keysOf(a, colours_a) != keysOf(b, colours_b)) return false;
  const Classes classes_a = classesOf(colours_a), classes_b = classesOf(colours_b);
  const std::vector<std::size_t>* smallest = nullptr;
  for (const auto& [colour, nodes] : classes_a) {
    if (!classes_b.contains(colour) || classes_b.at(colour).size() != nodes.size()) return false;
    if (nodes.size() > 1 && (!smallest || nodes.size() < smallest->size())) smallest = &nodes;
  }
  if (!smallest || areUntied(a, colours_a, classes_a)) return true;
  const Key chosen = mixed(3, depth);
  const std::vector<std::size_t>& candidates = classes_b.at(colours_a[smallest->front()]);
  colours_a[smallest->front()] = chosen;
  return std::any_of(candidates.begin(), candidates.end(), [&](std::size_t node) {
    Colours colours = colours_b;
    colours[node] = chosen;
    return match(a, colours_a, b, std::move(colours), depth + 1);
  });
}

bool isSame(const Part& a, const Part& b) {
  return (a.isTold() && b.isTold()) || match(a.rows, a.colours, b.rows, b.colours, 0);
}

/// Groups parts with equal keys into isomorphism classes and counts how many more of each class `a` has than `b`.
bool balanced(const std::vector<const Part*>& a, const std::vector<const Part*>& b) {
  std::vector<std::pair<const Part*, long>> kinds;
  const auto count = [&kinds](const Part& part, long by) {
    const auto kind =
        std::find_if(kinds.begin(), kinds.end(), [&](const auto& known) { return isSame(*known.first, part); });
    if (kind != kinds.end())
      kind->second += by;
    else
      kinds.emplace_back(&part, by);
  };
  for (const Part* part : a) count(*part, 1);
  for (const Part* part : b) count(*part, -1);
  return std::all_of(kinds.begin(), kinds.end(), [](const auto& kind) { return kind.second == 0; });
}

using PartsByKeys = std::map<std::vector<Key>, std::vector<const Part*>>;

PartsByKeys byKeys(const std::vector<Part>& parts) {
  PartsByKeys sorted;
  for (const Part& part : parts) sorted[keysOf(part.rows, part.colours)].push_back(&part);
  return sorted;
}

}  // namespace

bool isomorphic(const std::vector<Tuple>& a, const std::vector<Tuple>& b) {
  if (a.size() != b.size()) return false;
  const Coded coded_a = coded(a), coded_b = coded(b);
  if (coded_a.nodes != coded_b.nodes) return false;
  const Colours colours_a = refined(coded_a.rows, Colours(coded_a.nodes, 7)),
                colours_b = refined(coded_b.rows, Colours(coded_b.nodes, 7));
  // Rows without blank nodes are compared first, which finds most differences.
  if (keysOf(coded_a.rows, colours_a) != keysOf(coded_b.rows, colours_b)) return false;
  const std::vector<Part> parts_a = partsOf(coded_a, colours_a), parts_b = partsOf(coded_b, colours_b);
  const PartsByKeys sorted_a = byKeys(parts_a), sorted_b = byKeys(parts_b);
  return sorted_a.size() == sorted_b.size() &&
         std::all_of(sorted_a.begin(), sorted_a.end(), [&sorted_b](const auto& entry) {
           const auto other = sorted_b.find(entry.first);
           return other != sorted_b.end() && balanced(entry.second, other->second);
         });
}

}  // namespace cluxel::test
