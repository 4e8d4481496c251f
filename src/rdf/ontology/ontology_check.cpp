// SPDX-License-Identifier: Apache-2.0
// Checks ontology files for what would silently change the answers: misspelt names, and usual places that tell too
// little or too much.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>

#include "base/ascii.hpp"
#include "base/utf8.hpp"
#include "rdf/iri.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/ontology/ontology_statements.hpp"
#include "rdf/ontology/superclass_chains.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

using namespace vocabulary;

/// Their terms are defined elsewhere, also when an ontology says more about some of them.
bool isForeign(const std::string& name_space) {
  constexpr std::array kForeign{kRdf, kRdfs, kOwl, kXsd, kGeo, kSosa, kProv, kDcTerms, kSkos};
  return std::find(kForeign.begin(), kForeign.end(), name_space) != kForeign.end();
}

std::optional<double> finite(const Term& term) {
  double value = 0;
  const char* end = term.text.data() + term.text.size();
  const char* begin = term.text.starts_with('+') ? term.text.data() + 1 : term.text.data();
  const auto read = std::from_chars(begin, end, value);
  if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Finds names of classes and properties that are defined nowhere.
class NameCheck {
 public:
  explicit NameCheck(OntologyStatements& ontology) : ontology_(ontology) {}

  void check() {
    for (const OntologyStatement& statement : ontology_.all()) note(statement.quad);
    noteOwn();
    for (const OntologyStatement& statement : ontology_.all()) {
      checkSuperclass(statement);
      checkProperty(statement);
    }
  }

 private:
  void note(const Quad& quad) {
    const std::string& property = quad.predicate.text;
    const bool is_property = property == rdf("type") && quad.object.text.ends_with("Property");
    if (is_property || property == rdfs("subPropertyOf")) properties_.insert(quad.subject.text);
    if (property == rdfs("subClassOf")) subclasses_[quad.object.text].insert(quad.subject.text);
    if (property == rdfs("subClassOf")) undeclared_.insert(quad.subject.text);
  }

  /// An ontology may say something of a class of another vocabulary. Only those that define kinds of objects or parts
  /// are this ontology's own.
  void noteOwn() {
    own_.insert(std::string(kClx));
    std::set<std::string> below;
    std::vector<std::string> next{clx("Object"), clx("Part")};
    while (!next.empty()) {
      const std::string name = std::move(next.back());
      next.pop_back();
      if (!below.insert(name).second) continue;
      if (ontology_.classes().contains(name) && !isForeign(namespaceOf(name))) own_.insert(namespaceOf(name));
      const auto found = subclasses_.find(name);
      if (found != subclasses_.end()) next.insert(next.end(), found->second.begin(), found->second.end());
    }
  }

  void checkSuperclass(const OntologyStatement& statement) {
    const Quad& quad = statement.quad;
    if (quad.predicate.text != rdfs("subClassOf") || ontology_.isClass(quad.object)) return;
    if (quad.object.kind == TermKind::BlankNode) return;  // an axiom of OWL, such as a restriction
    if (quad.object.kind == TermKind::Iri && !own_.contains(namespaceOf(quad.object.text))) return;
    if (undeclared_.contains(quad.object.text))
      ontology_.fault(statement, localName(quad.object.text) + " is not declared as a class",
                      "write for it: a owl:Class");
    else
      ontology_.faultOfClass(statement);
  }

  void checkProperty(const OntologyStatement& statement) {
    const std::string& property = statement.quad.predicate.text;
    if (!property.starts_with(kClx) || properties_.contains(property)) return;
    ontology_.fault(statement, "there is no property " + localName(property), similarNameHint(property, properties_),
                    localName(property));
  }

  OntologyStatements& ontology_;
  std::set<std::string> own_;                                ///< namespaces
  std::map<std::string, std::set<std::string>> subclasses_;  ///< by superclass
  std::set<std::string> undeclared_;  ///< what has superclasses, whether it is declared as a class or not
  /// What the program reads needs no declaration.
  std::set<std::string> properties_{clx("color"),     clx("mobility"), clx("mayHavePart"), clx("usualFor"),
                                    clx("nearClass"), clx("within"),   clx("probability"), clx("unit")};
};

/// Turtle begins neither with a tag nor with the brace of JSON or of a graph.
void requireTurtle(std::span<const RdfSource> sources) {
  std::vector<Diagnostic> faults;
  for (const RdfSource& source : sources) {
    if (source.format != RdfFormat::Turtle) continue;
    const std::string_view text = trimmed(withoutByteOrderMark(source.text));
    const std::array kTags{"<?xml", "<!--", "<!DOCTYPE", "<rdf:RDF"};
    const bool is_xml = std::any_of(kTags.begin(), kTags.end(), [&](const char* tag) { return text.starts_with(tag); });
    if (is_xml || text.starts_with('{'))
      faults.push_back(
          {Severity::Error,
           {.file = source.name, .line = 1, .column = 1},
           std::string("this is ") + (is_xml ? "XML" : "JSON or TriG") + ", but an ontology is read as Turtle",
           "convert the file to Turtle (.ttl)",
           ""});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

/// The closure takes time that grows with the cube of the length of a chain.
constexpr std::size_t kMaxSuperclasses = 500;

void checkChains(OntologyStatements& ontology) {
  std::map<std::string, std::set<std::string>> above;
  for (const OntologyStatement& statement : ontology.all())
    if (statement.quad.predicate.text == rdfs("subClassOf") && statement.quad.object.kind == TermKind::Iri)
      above[statement.quad.subject.text].insert(statement.quad.object.text);
  const std::vector<std::string> chain = SuperclassChains(above).longest();
  if (chain.size() <= kMaxSuperclasses + 1) return;
  for (const OntologyStatement& statement : ontology.all())
    if (statement.quad.subject.text == chain[0] && statement.quad.object.text == chain[1] &&
        statement.quad.predicate.text == rdfs("subClassOf"))
      return ontology.fault(statement,
                            "it has a chain of " + std::to_string(chain.size() - 1) +
                                " superclasses above each other, up to " + localName(chain.back()),
                            "write at most " + std::to_string(kMaxSuperclasses) + " above each other");
}

/// Checks usual places, and that nothing has two values of a property that is read once.
class ValueCheck {
 public:
  explicit ValueCheck(OntologyStatements& ontology) : ontology_(ontology) {}

  void check() {
    for (const OntologyStatement& statement : ontology_.all()) note(statement);
    checkOnce();
    for (const auto& [place, statement] : places_) checkPlace(place, *statement);
    checkSums();
  }

 private:
  using Statements = std::vector<const OntologyStatement*>;

  void note(const OntologyStatement& statement) {
    const Quad& quad = statement.quad;
    Statements& same = values_[{quad.subject, quad.predicate.text}];
    const auto isEqual = [&](const OntologyStatement* other) { return other->quad.object == quad.object; };
    if (std::none_of(same.begin(), same.end(), isEqual)) same.push_back(&statement);
    const std::string& property = quad.predicate.text;
    const bool is_place = property == clx("usualFor") || property == clx("nearClass") || property == clx("within") ||
                          property == clx("probability") ||
                          (property == rdf("type") && quad.object.text == clx("UsualPlace"));
    if (is_place) places_.try_emplace(quad.subject, &statement);
  }

  const Statements& valuesOf(const Term& subject, const char* property) const {
    static const Statements kNone;
    const auto found = values_.find({subject, clx(property)});
    return found == values_.end() ? kNone : found->second;
  }

  void checkOnce() {
    for (const auto& [key, statements] : values_)
      for (const char* name : {"color", "mobility", "within", "probability"})
        if (key.second == clx(name) && statements.size() > 1)
          ontology_.fault(*statements.back(), "it has more than one clx:" + std::string(name), "keep one of them");
  }

  void checkPlace(const Term& place, const OntologyStatement& statement) {
    for (const char* name : {"usualFor", "nearClass", "within", "probability"})
      if (valuesOf(place, name).empty())
        ontology_.fault(statement, "the usual place has no clx:" + std::string(name),
                        "a usual place has clx:usualFor, clx:nearClass, clx:within and clx:probability");
    for (const OntologyStatement* within : valuesOf(place, "within")) {
      const auto distance_m = finite(within->quad.object);
      if (!distance_m || *distance_m <= 0)
        ontology_.fault(*within, "clx:within is '" + within->quad.object.text + "'", "write a distance above 0 [m]");
    }
  }

  /// The places of a class exclude each other, so that what is left of 1 is anywhere else.
  void checkSums() {
    constexpr double rounding = 1e-9;
    std::map<std::string, double> sums;
    std::map<std::string, const OntologyStatement*> last;
    for (const auto& [place, any] : places_)
      for (const OntologyStatement* usual : valuesOf(place, "usualFor")) {
        const Statements& probabilities = valuesOf(place, "probability");
        if (probabilities.size() != 1) continue;
        const double near = static_cast<double>(valuesOf(place, "nearClass").size());  // each is a place of its own
        sums[usual->quad.object.text] += near * finite(probabilities.front()->quad.object).value_or(0);
        last[usual->quad.object.text] = usual;
      }
    for (const auto& [name, sum] : sums) {
      if (sum <= 1 + rounding) continue;
      std::array<char, 32> text{};
      std::snprintf(text.data(), text.size(), "%.6g", sum);
      ontology_.fault(*last[name],
                      "the probabilities of the usual places of " + localName(name) + " sum to " + text.data(),
                      "they sum to at most 1");
    }
  }

  OntologyStatements& ontology_;
  std::map<std::pair<Term, std::string>, Statements> values_;  ///< by subject and property, without repetitions
  std::map<Term, const OntologyStatement*> places_;            ///< with a statement about each
};

}  // namespace

void checkOntology(std::span<const RdfSource> sources) {
  requireTurtle(sources);
  OntologyStatements ontology(sources);
  checkOntologyBasics(ontology);
  NameCheck(ontology).check();
  ValueCheck(ontology).check();
  checkChains(ontology);
  ontology.requireNone();
}

}  // namespace cluxel::rdf
