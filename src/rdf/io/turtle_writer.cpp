// SPDX-License-Identifier: Apache-2.0
// Writes Turtle. Raptor's serialiser (2.0.15) is not used: it writes "INF"^^xsd:double as a bare INF, merges literals
// of equal value and refuses ill-typed ones, so its output does not round-trip.
#include "rdf/io/turtle_writer.hpp"

#include <algorithm>
#include <vector>

#include "base/ascii.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

/// A subset of PN_LOCAL that all Turtle parsers accept.
bool isPlainLocal(std::string_view local) {
  if (local.empty() || !(isAsciiLetter(local.front()) || local.front() == '_')) return false;
  return std::all_of(local.begin(), local.end(),
                     [](char c) { return isAsciiLetter(c) || isAsciiDigit(c) || c == '_' || c == '-'; });
}

/// True when the bare lexical form is Turtle shorthand for exactly this literal.
bool isBare(const Term& term) {
  if (term.datatype == vocabulary::xsd("boolean")) return term.text == "true" || term.text == "false";
  std::string_view digits = term.text;
  if (digits.starts_with('-') || digits.starts_with('+')) digits.remove_prefix(1);
  const auto all_digits = [](std::string_view part) {
    return !part.empty() && std::all_of(part.begin(), part.end(), isAsciiDigit);
  };
  if (term.datatype == vocabulary::xsd("integer")) return all_digits(digits);
  if (term.datatype != vocabulary::xsd("decimal")) return false;
  const std::size_t point = digits.find('.');
  return point != std::string_view::npos && all_digits(digits.substr(0, point)) && all_digits(digits.substr(point + 1));
}

struct WrittenTriple {
  Term subject, predicate, object;
  auto operator<=>(const WrittenTriple&) const = default;
};

bool isType(const Term& predicate) {
  return predicate.text == vocabulary::rdf("type");
}

/// Orders by subject, then rdf:type first, then by term.
bool comesBefore(const WrittenTriple& a, const WrittenTriple& b) {
  if (a.subject != b.subject) return a.subject < b.subject;
  if (a.predicate != b.predicate) {
    if (isType(a.predicate) != isType(b.predicate)) return isType(a.predicate);
    return a.predicate < b.predicate;
  }
  return a.object < b.object;
}

std::vector<WrittenTriple> triplesOf(const QuadReader& reader, const std::optional<Term>& graph) {
  std::vector<WrittenTriple> triples;
  QuadPattern pattern;
  std::optional<TermId> history;
  if (graph) {
    pattern.g = reader.idOf(*graph);
    if (!pattern.g) return triples;
  } else {
    history = reader.idOf(Term::iri(vocabulary::kGraphHistory));
  }
  QuadCursor cursor = reader.scan(pattern);
  for (QuadIds quad; cursor.next(quad);)
    if (!history || quad.g != *history)
      triples.push_back({reader.termOf(quad.s), reader.termOf(quad.p), reader.termOf(quad.o)});
  std::sort(triples.begin(), triples.end(), comesBefore);
  triples.erase(std::unique(triples.begin(), triples.end()), triples.end());
  return triples;
}

}  // namespace

std::string TurtleTerms::iri(const std::string& full) const {
  for (const auto& [prefix, start] : prefixes_)
    if (full.starts_with(start) && isPlainLocal(std::string_view(full).substr(start.size())))
      return prefix + ':' + full.substr(start.size());
  return toNTriples(Term::iri(full));
}

std::string TurtleTerms::text(const Term& term) const {
  if (term.kind == TermKind::Iri) return iri(term.text);
  if (term.kind == TermKind::BlankNode) return toNTriples(term);
  if (isBare(term)) return term.text;
  const bool named = term.language.empty() && term.datatype != vocabulary::xsd("string");
  if (!named) return toNTriples(term);
  return toNTriples(Term::literal(term.text)) + "^^" + iri(term.datatype);
}

std::string TurtleTerms::header() const {
  std::string text;
  for (const auto& [prefix, start] : prefixes_)
    text += "@prefix " + prefix + ": " + toNTriples(Term::iri(start)) + " .\n";
  return text;
}

void writeTurtle(const QuadReader& reader, const std::optional<Term>& graph, const TextSink& out,
                 const RdfPrefixes& prefixes) {
  const TurtleTerms terms(prefixes);
  out(terms.header());
  const std::vector<WrittenTriple> triples = triplesOf(reader, graph);
  for (std::size_t i = 0; i < triples.size(); ++i) {
    const bool same_subject = i > 0 && triples[i].subject == triples[i - 1].subject;
    const bool same_predicate = same_subject && triples[i].predicate == triples[i - 1].predicate;
    std::string text;
    if (!same_subject) text = (i > 0 ? " .\n\n" : "\n") + terms.text(triples[i].subject) + ' ';
    if (same_subject) text = same_predicate ? ", " : " ;\n    ";
    if (!same_predicate) text += (isType(triples[i].predicate) ? "a" : terms.text(triples[i].predicate)) + ' ';
    out(text + terms.text(triples[i].object));
  }
  if (!triples.empty()) out(" .\n");
}

}  // namespace cluxel::rdf
