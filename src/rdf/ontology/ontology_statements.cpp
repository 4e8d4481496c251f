// SPDX-License-Identifier: Apache-2.0
// Parses ontology files and finds the place of a fault in their text.
#include "rdf/ontology/ontology_statements.hpp"

#include <algorithm>

#include "base/ascii.hpp"
#include "base/nearest_name.hpp"
#include "base/shown_line.hpp"
#include "rdf/iri.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

bool isNameByte(char c) {
  return isAsciiAlphanumeric(c) || c == '_' || c == '-';
}

/// Searches a name in the source text, because raptor does not report the locations of statements.
std::size_t findName(std::string_view text, std::string_view name, std::size_t start) {
  for (std::size_t at = text.find(name, start); at != std::string_view::npos; at = text.find(name, at + 1)) {
    const bool begins = at == 0 || !isNameByte(text[at - 1]);
    const bool ends = at + name.size() == text.size() || !isNameByte(text[at + name.size()]);
    if (begins && ends && !name.empty()) return at;
  }
  return std::string_view::npos;
}

/// Where the statements about a subject begin: its name at the start of a line, else its first mention.
std::size_t findSubject(std::string_view text, std::string_view name) {
  for (std::size_t at = findName(text, name, 0); at != std::string_view::npos; at = findName(text, name, at + 1)) {
    const std::size_t line = text.find_last_of('\n', at) + 1;  // npos + 1 is 0: the first line
    if (text.substr(line, at - line).find_first_of(" \t#") == std::string_view::npos) return at;
  }
  return findName(text, name, 0);
}

/// Blank nodes have labels that no file shows.
std::string shownName(const Term& term) {
  return term.kind == TermKind::BlankNode ? "what has no name ([ … ])" : localName(term.text);
}

/// One that differs from the IRI in the namespace alone.
std::set<std::string>::const_iterator namesake(const std::set<std::string>& known, std::string_view iri) {
  return std::find_if(known.begin(), known.end(),
                      [&](const std::string& name) { return name != iri && localName(name) == localName(iri); });
}

}  // namespace

OntologyStatements::OntologyStatements(std::span<const RdfSource> sources) : sources_(sources) {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    try {
      parseRdf(sources_[i], [&](const Quad& quad) { statements_.push_back({quad, i}); });
    } catch (const InputError& error) {
      faults_.insert(faults_.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  }
  requireNone();
  using namespace vocabulary;
  for (const OntologyStatement& statement : statements_) {
    const Quad& quad = statement.quad;
    const bool is_class = quad.object.text == std::string(kOwl) + "Class" || quad.object.text == rdfs("Class");
    if (quad.predicate.text == rdf("type") && is_class && quad.subject.kind == TermKind::Iri)
      classes_.insert(quad.subject.text);
  }
}

void OntologyStatements::fault(const OntologyStatement& statement, const std::string& message, std::string hint,
                               std::string_view word) {
  const RdfSource& source = sources_[statement.source];
  const Quad& quad = statement.quad;
  Diagnostic diagnostic;
  diagnostic.location.file = source.name;
  diagnostic.message = shownName(quad.subject) + ": " + message;
  diagnostic.hint = std::move(hint);
  const bool is_named = quad.subject.kind == TermKind::Iri;
  const std::size_t subject = is_named ? findSubject(source.text, localName(quad.subject.text)) : 0;
  if (subject != std::string_view::npos) {
    const std::string object = quad.object.kind == TermKind::Iri ? localName(quad.object.text) : quad.object.text;
    const std::size_t found = findName(source.text, word.empty() ? object : word, subject);
    const std::size_t at = found == std::string_view::npos ? subject : found;
    // The first byte of the file says nothing about a fault of something unnamed.
    if (is_named || found != std::string_view::npos) diagnostic.location = locate(source.name, source.text, at);
    if (diagnostic.location.line > 0) diagnostic.source_line = shownLine(source.text, diagnostic.location.line);
  }
  faults_.push_back(std::move(diagnostic));
}

void OntologyStatements::faultOfClass(const OntologyStatement& statement) {
  const Term& name = statement.quad.object;
  const std::string property = localName(statement.quad.predicate.text);
  if (name.kind == TermKind::Iri)
    fault(statement,
          "there is no class " +
              (namesake(classes_, name.text) != classes_.end() ? "<" + name.text + ">" : localName(name.text)),
          similarNameHint(name.text, classes_));
  else
    fault(statement,
          property + " has " + (name.kind == TermKind::BlankNode ? "something unnamed" : "a text or number") +
              " where a class is wanted",
          "write the name of a class, such as clx:Tree", property);
}

void OntologyStatements::requireNone() const {
  if (!faults_.empty()) throw InputError(faults_);
}

std::string similarNameHint(std::string_view iri, const std::set<std::string>& known) {
  std::vector<std::string> names;
  for (const std::string& name : known)
    if (namespaceOf(name) == namespaceOf(iri)) names.push_back(localName(name));
  if (const auto near = nearestName(localName(iri), names)) return "did you mean '" + *near + "'?";
  const auto same = namesake(known, iri);
  return same != known.end() ? "did you mean <" + *same + ">?" : "";
}

}  // namespace cluxel::rdf
