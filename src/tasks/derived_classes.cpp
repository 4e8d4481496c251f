// SPDX-License-Identifier: Apache-2.0
// Each derived fact has a clx:Derivation that names its rule.
#include "tasks/derived_classes.hpp"

#include <algorithm>

#include "mapping/inference/rule_queries.hpp"
#include "mapping/statements/excluded_types.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/objects_of_class.hpp"
#include "tasks/rule_classes.hpp"

namespace cluxel::tasks {

namespace {

/// The objects of a subject's property in any graph but history.
std::vector<Term> valuesOf(const rdf::QuadReader& quads, rdf::TermId subject, const std::string& property) {
  const auto predicate = quads.idOf(Term::iri(property));
  const auto history = quads.idOf(Term::iri(std::string(rdf::vocabulary::kGraphHistory)));
  std::vector<Term> values;
  if (!predicate) return values;
  rdf::QuadCursor cursor = quads.scan({.s = subject, .p = predicate, .o = {}, .g = {}});
  for (rdf::QuadIds quad; cursor.next(quad);)
    if (!history || quad.g != *history) values.push_back(quads.termOf(quad.o));
  return values;
}

/// "SPARQL rule F can say clx:Fence of an object, and does not of this one"; empty when it cannot.
std::string whatItCanSay(const mapping::NamedText& rule, const rules::RuleSet& rules, const rdf::OntologyView& ontology,
                         const std::string& class_iri) {
  const std::string begin = "SPARQL rule " + mapping::ruleFileName(rule), name = rules.shorten(class_iri);
  const std::string end = " of an object, and does not of this one\n";
  const GivenClasses given = classesGivenBy(rule);
  if (given.named.contains(class_iri)) return begin + " can say " + name + end;
  std::string below;
  for (const std::string& named : given.named)
    if (ontology.isA(named, class_iri)) below += (below.empty() ? "" : " or ") + rules.shorten(named);
  if (!below.empty()) return begin + " can say " + below + ", which is " + name + "," + end;
  return given.is_open ? begin + " computes what it says, so that it may say " + name + end : "";
}

/// Tells whether statements rule out the class.
std::string ruledOutText(const rdf::QuadReader& quads, const std::string& object_iri, const std::string& class_iri,
                         const std::string& name, nlohmann::ordered_json& json) {
  std::string text;
  for (const std::string& statement : mapping::statementsAgainst(quads, object_iri, class_iri)) {
    const std::string id = statement.substr(statement.rfind('/') + 1);
    json["ruled_out_by"].push_back(id);
    text += "operator statement " + id + " rules out that a SPARQL rule says " + name + "\n";
  }
  return text;
}

}  // namespace

std::vector<DerivedClass> derivedClassesOf(const rdf::QuadReader& quads, const std::string& thing_iri) {
  const auto thing = quads.idOf(Term::iri(thing_iri));
  const auto subject = quads.idOf(Term::iri(rdf::vocabulary::rdf("subject")));
  const auto graph = quads.idOf(Term::iri(std::string(rdf::vocabulary::kGraphInferred)));
  std::vector<DerivedClass> derived;
  if (!thing || !subject || !graph) return derived;
  rdf::QuadCursor cursor = quads.scan({.s = {}, .p = subject, .o = thing, .g = graph});
  for (rdf::QuadIds quad; cursor.next(quad);) {
    const std::vector<Term> properties = valuesOf(quads, quad.s, rdf::vocabulary::rdf("predicate"));
    if (properties.size() != 1 || properties.front().text != rdf::vocabulary::rdf("type")) continue;
    for (const Term& class_term : valuesOf(quads, quad.s, rdf::vocabulary::rdf("object")))
      for (const Term& rule : valuesOf(quads, quad.s, rdf::vocabulary::clx("rule")))
        derived.push_back({class_term.text, rule.text});
  }
  std::sort(derived.begin(), derived.end());
  return derived;
}

std::string derivedClassesText(const mapping::MapReader& map, const rules::RuleSet& rules, const ContentHash& object,
                               nlohmann::ordered_json& json) {
  std::string text;
  for (const DerivedClass& derived : derivedClassesOf(map.quads(), rdf::iriOfObject(object))) {
    const std::string name = rules.shorten(derived.class_iri);
    json["derived"].push_back({{"class", name}, {"rule", derived.file}});
    text += "also " + name + ", by SPARQL rule " + derived.file + "\n";
  }
  return text;
}

std::string sparqlRulesText(const mapping::MapReader& map, const rules::RuleSet& rules,
                            const mapping::MapInputs& inputs, const std::optional<ContentHash>& object,
                            const std::string& class_iri, nlohmann::ordered_json& json) {
  const std::string name = rules.shorten(class_iri);
  std::string text;
  if (object) {
    const bool is_of_class = isOfClass(map.quads(), *object, class_iri);
    json["is_of_class"] = is_of_class;
    text = derivedClassesText(map, rules, *object, json);
    if (is_of_class) return "it is " + name + " already\n" + text;
    text += ruledOutText(map.quads(), rdf::iriOfObject(*object), class_iri, name, json);
  }
  if (!object) return text;
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  for (const mapping::NamedText& rule : inputs.sparql_rules)
    if (const std::string of_rule = whatItCanSay(rule, rules, ontology, class_iri); !of_rule.empty()) {
      json["sparql_rules"].push_back(mapping::ruleFileName(rule));
      text += of_rule;
    }
  return text;
}

}  // namespace cluxel::tasks
