// SPDX-License-Identifier: Apache-2.0
// Loads ontologies and checks them beyond RDF syntax.
#include <charconv>
#include <map>
#include <set>

#include "rdf/iri.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/ontology/ontology_statements.hpp"
#include "rdf/ontology/superclass_chains.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

using namespace vocabulary;

class BasicCheck {
 public:
  explicit BasicCheck(OntologyStatements& ontology) : ontology_(ontology) {}

  void check() {
    for (const OntologyStatement& statement : ontology_.all()) note(statement.quad);
    for (const OntologyStatement& statement : ontology_.all()) checkStatement(statement);
    checkCycles();
  }

 private:
  void note(const Quad& quad) {
    if (quad.predicate.text == rdfs("subClassOf") && quad.object.kind == TermKind::Iri)
      above_[quad.subject.text].insert(quad.object.text);
  }

  void checkStatement(const OntologyStatement& statement) {
    const std::string& property = statement.quad.predicate.text;
    const Term& object = statement.quad.object;
    if (property == clx("color") && !isColor(object)) ontology_.fault(statement, "a colour is written #rrggbb");
    if (property == clx("mobility") && object.text != clx("Static") && object.text != clx("Movable"))
      ontology_.fault(statement, "a mobility is clx:Static or clx:Movable");
    if (property == clx("probability") && !isProbability(object))
      ontology_.fault(statement, "a probability lies in 0 to 1");
    const bool names_class =
        property == clx("mayHavePart") || property == clx("nearClass") || property == clx("usualFor");
    if (names_class && !ontology_.isClass(object)) ontology_.faultOfClass(statement);
  }

  void checkCycles() {
    const SuperclassChains chains(above_);
    for (const OntologyStatement& statement : ontology_.all()) {
      const bool may_lie_in_cycle =
          statement.quad.predicate.text == rdfs("subClassOf") && !chains.isClear(statement.quad.subject.text);
      if (!may_lie_in_cycle) continue;
      if (reaches(statement.quad.object.text, statement.quad.subject.text))
        ontology_.fault(statement, "the class is its own superclass: " + localName(statement.quad.subject.text) +
                                       " is below " + localName(statement.quad.object.text) + " and above it");
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

  OntologyStatements& ontology_;
  std::map<std::string, std::set<std::string>> above_;
};

}  // namespace

void checkOntologyBasics(OntologyStatements& ontology) {
  BasicCheck(ontology).check();
}

void loadOntology(std::span<const RdfSource> sources, QuadWriter& writer) {
  OntologyStatements ontology(sources);
  checkOntologyBasics(ontology);
  ontology.requireNone();
  for (const OntologyStatement& statement : ontology.all()) {
    Quad quad = statement.quad;
    quad.graph = Term::iri(kGraphOntology);
    writer.add(quad);
  }
}

}  // namespace cluxel::rdf
