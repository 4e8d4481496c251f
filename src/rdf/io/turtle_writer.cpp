// SPDX-License-Identifier: Apache-2.0
// Writes Turtle. Raptor's serialiser (2.0.15) is not used: it writes "INF"^^xsd:double as a bare INF, merges literals
// of equal value and refuses ill-typed ones, so its output does not round-trip.
#include "rdf/io/turtle_writer.hpp"

#include <algorithm>
#include <cstring>

#include "base/ascii.hpp"
#include "base/sorting/sorted_records.hpp"
#include "rdf/io/sorted_subjects.hpp"
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

bool isType(std::string_view predicate) {
  static const std::string type = vocabulary::rdf("type");
  return predicate == type;
}

/// Appends a text so that bytewise order is that of the texts, whatever follows: an end that no byte comes before.
void appendOrdered(std::string& key, std::string_view text) {
  constexpr char kEnd = 0, kZeroOfText = 1;
  for (const char c : text) {
    key += c;
    if (c == kEnd) key += kZeroOfText;
  }
  key.append(2, kEnd);
}

/// Appends what orders as the term does.
void appendOrdered(std::string& key, const TermView& term) {
  key += static_cast<char>(term.kind);
  for (const std::string_view text : {term.text, term.datatype, term.language}) appendOrdered(key, text);
}

/// A predicate and an object behind the key that orders them: rdf:type first, then by term.
struct PredicateObject {
  TermId predicate = kNoTerm, object = kNoTerm;
};

std::string keyOf(const QuadReader& reader, const PredicateObject& pair) {
  const TermView predicate = reader.viewOf(pair.predicate);
  std::string key(1, isType(predicate.text) ? '0' : '1');
  appendOrdered(key, predicate);
  appendOrdered(key, reader.viewOf(pair.object));
  return key.append(reinterpret_cast<const char*>(&pair), sizeof pair);
}

PredicateObject pairOf(std::string_view key) {
  PredicateObject pair;
  std::memcpy(&pair, key.data() + key.size() - sizeof pair, sizeof pair);
  return pair;
}

/// Writes one subject after the other.
class TurtleSubjects {
 public:
  TurtleSubjects(const QuadReader& reader, const TextSink& out, const RdfPrefixes& prefixes)
      : reader_(reader), out_(out), terms_(prefixes) {}

  void writeHeader() { out_(terms_.header()); }
  void writePair(TermId subject, const PredicateObject& pair) {
    const bool is_new = subject != subject_;
    text_.clear();
    if (is_new) text_ = (subject_ != kNoTerm ? " .\n\n" : "\n") + textOf(subject) + ' ';
    if (!is_new) text_ = pair.predicate == predicate_ ? ", " : " ;\n    ";
    if (is_new || pair.predicate != predicate_) {
      const Term predicate = reader_.termOf(pair.predicate);
      (text_ += isType(predicate.text) ? "a" : terms_.text(predicate)) += ' ';
    }
    subject_ = subject;
    predicate_ = pair.predicate;
    out_(text_ += textOf(pair.object));
  }
  void writeEnd() {
    if (subject_ != kNoTerm) out_(" .\n");
  }

 private:
  std::string textOf(TermId id) const { return terms_.text(reader_.termOf(id)); }

  const QuadReader& reader_;
  const TextSink& out_;
  TurtleTerms terms_;
  TermId subject_ = kNoTerm, predicate_ = kNoTerm;  ///< of the last triple
  std::string text_;
};

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
                 const RdfPrefixes& prefixes, std::size_t sort_bytes) {
  TurtleSubjects writer(reader, out, prefixes);
  writer.writeHeader();
  const std::optional<TermId> one_graph = graph ? reader.idOf(*graph) : std::nullopt;
  if (graph && !one_graph) return;
  const std::optional<TermId> history = graph ? std::nullopt : reader.idOf(Term::iri(vocabulary::kGraphHistory));
  SortedSubjects subjects(reader, one_graph);
  SortedRecords pairs(sort_bytes);
  const auto append_key = [&](std::string& key, TermId subject) { appendOrdered(key, reader.viewOf(subject)); };
  const auto write_subject = [&](std::string_view, TermId subject) {
    subjects.forEachQuadOf(subject, [&](const QuadIds& quad) {
      if (quad.g != history) pairs.add(keyOf(reader, {quad.p, quad.o}));
    });
    pairs.drain([&](std::string_view key) { writer.writePair(subject, pairOf(key)); });
  };
  subjects.forEach(append_key, write_subject, sort_bytes);
  writer.writeEnd();
}

}  // namespace cluxel::rdf
