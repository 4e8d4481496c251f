// SPDX-License-Identifier: Apache-2.0
// Quads are copied by their terms: term ids differ between stores.
#include "mapping/build/operator_statements.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "base/disjoint_sets.hpp"
#include "rdf/io/canonical_labels.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

Term withSuffix(const Term& term, const std::string& suffix) {
  return term.kind == TermKind::BlankNode && !suffix.empty() ? Term::blank(term.text + suffix) : term;
}

bool isBlank(const Term& term) {
  return term.kind == TermKind::BlankNode;
}

/// Quads that name blank nodes which belong together, in lists of their own; each other quad alone.
std::vector<std::vector<Quad>> togetherIn(const std::vector<Quad>& quads) {
  std::map<std::string, std::uint32_t> number;
  for (const Quad& quad : quads)
    for (const Term* term : {&quad.subject, &quad.object})
      if (isBlank(*term)) number.emplace(term->text, static_cast<std::uint32_t>(number.size()));
  DisjointSets sets(number.size());
  for (const Quad& quad : quads)
    if (isBlank(quad.subject) && isBlank(quad.object))
      sets.join(number.at(quad.subject.text), number.at(quad.object.text));
  std::map<std::uint32_t, std::vector<Quad>> of_blanks;
  std::vector<std::vector<Quad>> lists;
  for (const Quad& quad : quads) {
    if (!isBlank(quad.subject) && !isBlank(quad.object))
      lists.push_back({quad});
    else
      of_blanks[sets.find(number.at((isBlank(quad.subject) ? quad.subject : quad.object).text))].push_back(quad);
  }
  for (auto& [root, list] : of_blanks) lists.push_back(std::move(list));
  return lists;
}

/// Blank nodes that are too much alike for canonical labels keep theirs.
std::string canonicalTextOf(std::vector<Quad> together) {
  const std::map<std::string, std::string> labels = rdf::canonicalLabels(together);
  std::vector<std::string> lines;
  for (Quad& quad : together) {
    for (Term* term : {&quad.subject, &quad.object})
      if (isBlank(*term) && !labels.empty()) term->text = labels.at(term->text);
    lines.push_back(toNQuads(quad));
  }
  std::sort(lines.begin(), lines.end());
  std::string text;
  for (const std::string& line : lines) text += line;
  return text;
}

}  // namespace

std::set<std::string> canonicalTextsOf(const std::vector<Quad>& quads) {
  std::set<std::string> texts;
  for (const std::vector<Quad>& together : togetherIn(quads)) texts.insert(canonicalTextOf(together));
  return texts;
}

std::uint64_t copyOperatorStatements(const rdf::QuadReader& from, rdf::WriteTransaction& into,
                                     const std::string& blank_suffix) {
  const std::vector<Quad> quads = operatorStatements(from, blank_suffix);
  addOperatorStatements(into, quads);
  return quads.size();
}

void removeDuplicatesOfBlankNodes(rdf::WriteTransaction& transaction) {
  const rdf::QuadReader reader(static_cast<const rdf::ReadTransaction&>(transaction));
  rdf::QuadWriter writer(transaction);
  std::set<std::string> known;
  for (const std::vector<Quad>& together : togetherIn(operatorStatements(reader))) {
    if (known.insert(canonicalTextOf(together)).second) continue;
    for (const Quad& quad : together)
      writer.remove(rdf::QuadIds{writer.intern(quad.subject), writer.intern(quad.predicate), writer.intern(quad.object),
                                 writer.intern(quad.graph)});
  }
  writer.flush();
}

void addOperatorStatements(rdf::WriteTransaction& transaction, const std::vector<Quad>& quads) {
  if (quads.empty()) return;
  rdf::QuadWriter writer(transaction);
  for (const Quad& quad : quads)
    writer.add(Quad{quad.subject, quad.predicate, quad.object, Term::iri(rdf::vocabulary::kGraphOperator)});
  writer.flush();
}

std::vector<Quad> operatorStatements(const rdf::QuadReader& reader, const std::string& blank_suffix) {
  const Term graph_term = Term::iri(rdf::vocabulary::kGraphOperator);
  const auto graph = reader.idOf(graph_term);
  if (!graph) return {};
  std::vector<Quad> quads;
  rdf::QuadCursor cursor = reader.scan({.s = {}, .p = {}, .o = {}, .g = *graph});
  for (rdf::QuadIds quad; cursor.next(quad);)
    quads.push_back({withSuffix(reader.termOf(quad.s), blank_suffix), reader.termOf(quad.p),
                     withSuffix(reader.termOf(quad.o), blank_suffix), graph_term});
  return quads;
}

void clearOperatorStatements(rdf::WriteTransaction& transaction) {
  rdf::QuadWriter writer(transaction);
  writer.clearGraph(writer.intern(Term::iri(rdf::vocabulary::kGraphOperator)));
  writer.flush();
}

}  // namespace cluxel::mapping
