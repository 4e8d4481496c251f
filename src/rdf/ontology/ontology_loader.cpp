// SPDX-License-Identifier: Apache-2.0
// Loads ontologies and checks them beyond RDF syntax.
#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "base/ascii.hpp"
#include "base/nearest_name.hpp"
#include "base/shown_line.hpp"
#include "rdf/iri.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

using namespace vocabulary;

/// A statement and its source.
struct Statement {
  Quad quad;
  std::size_t source = 0;
};

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

/// Collects the statements of all sources and reports faults.
class OntologyCheck {
 public:
  explicit OntologyCheck(std::span<const RdfSource> sources) : sources_(sources) {}

  void read() {
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      try {
        parseRdf(sources_[i], [&](const Quad& quad) { statements_.push_back({quad, i}); });
      } catch (const InputError& error) {
        faults_.insert(faults_.end(), error.diagnostics().begin(), error.diagnostics().end());
      }
    }
    if (!faults_.empty()) throw InputError(faults_);
  }

  void check() {
    for (const Statement& statement : statements_) note(statement);
    for (const Statement& statement : statements_) checkStatement(statement);
    checkCycles();
    if (!faults_.empty()) throw InputError(faults_);
  }

  const std::vector<Statement>& statements() const { return statements_; }

 private:
  void note(const Statement& statement) {
    const Quad& quad = statement.quad;
    if (quad.predicate.text == rdf("type") &&
        (quad.object.text == std::string(kOwl) + "Class" || quad.object.text == rdfs("Class")))
      classes_.insert(quad.subject.text);
    if (quad.predicate.text == rdfs("subClassOf") && quad.object.kind == TermKind::Iri)
      above_[quad.subject.text].insert(quad.object.text);
  }

  void checkStatement(const Statement& statement) {
    const std::string& property = statement.quad.predicate.text;
    const Term& object = statement.quad.object;
    if (property == clx("color") && !isColor(object)) fault(statement, "a colour is written #rrggbb");
    if (property == clx("mobility") && object.text != clx("Static") && object.text != clx("Movable"))
      fault(statement, "a mobility is clx:Static or clx:Movable");
    if (property == clx("probability") && !isProbability(object)) fault(statement, "a probability lies in 0 to 1");
    if (property == clx("mayHavePart") || property == clx("nearClass") || property == clx("usualFor"))
      checkClass(statement);
  }

  void checkClass(const Statement& statement) {
    const std::string& name = statement.quad.object.text;
    if (statement.quad.object.kind == TermKind::Iri && classes_.contains(name)) return;
    const std::vector<std::string> known(classes_.begin(), classes_.end());
    const std::optional<std::string> near = nearestName(name, known);
    fault(statement, "there is no class " + localName(name), near ? "did you mean '" + localName(*near) + "'?" : "");
  }

  void checkCycles() {
    for (const Statement& statement : statements_) {
      if (statement.quad.predicate.text != rdfs("subClassOf")) continue;
      if (reaches(statement.quad.object.text, statement.quad.subject.text))
        fault(statement, "the class is its own superclass: " + localName(statement.quad.subject.text) + " is below " +
                             localName(statement.quad.object.text) + " and above it");
    }
  }

  bool reaches(const std::string& from, const std::string& to) const {
    std::set<std::string> seen;
    std::vector<std::string> open = {from};
    while (!open.empty()) {
      const std::string next = std::move(open.back());
      open.pop_back();
      if (next == to) return true;
      const auto above = above_.find(next);
      if (!seen.insert(next).second || above == above_.end()) continue;
      open.insert(open.end(), above->second.begin(), above->second.end());
    }
    return false;
  }

  static bool isColor(const Term& term) {
    return term.text.size() == 7 && term.text[0] == '#' &&
           term.text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
  }

  static bool isProbability(const Term& term) {
    double value = -1;
    const char* end = term.text.data() + term.text.size();
    return std::from_chars(term.text.data(), end, value).ptr == end && value >= 0 && value <= 1;
  }

  void fault(const Statement& statement, const std::string& message, std::string hint = {}) {
    const RdfSource& source = sources_[statement.source];
    Diagnostic diagnostic;
    diagnostic.location.file = source.name;
    diagnostic.message = localName(statement.quad.subject.text) + ": " + message;
    diagnostic.hint = std::move(hint);
    const std::size_t subject = findName(source.text, localName(statement.quad.subject.text), 0);
    if (subject != std::string_view::npos) {
      const std::string object = statement.quad.object.kind == TermKind::Iri ? localName(statement.quad.object.text)
                                                                             : statement.quad.object.text;
      const std::size_t at = findName(source.text, object, subject);
      diagnostic.location = locate(source.name, source.text, at == std::string_view::npos ? subject : at);
      diagnostic.source_line = shownLine(source.text, diagnostic.location.line);
    }
    faults_.push_back(std::move(diagnostic));
  }

  std::span<const RdfSource> sources_;
  std::vector<Statement> statements_;
  std::vector<Diagnostic> faults_;
  std::set<std::string> classes_;
  std::map<std::string, std::set<std::string>> above_;
};

}  // namespace

void loadOntology(std::span<const RdfSource> sources, QuadWriter& writer) {
  OntologyCheck check(sources);
  check.read();
  check.check();
  for (const Statement& statement : check.statements()) {
    Quad quad = statement.quad;
    quad.graph = Term::iri(kGraphOntology);
    writer.add(quad);
  }
}

}  // namespace cluxel::rdf
