// SPDX-License-Identifier: Apache-2.0
// Each derived fact has a clx:Derivation that names its rule.
#include "tasks/derived_classes.hpp"

#include <algorithm>
#include <cctype>

#include "mapping/inference/rule_queries.hpp"
#include "mapping/inference/rule_shape.hpp"
#include "mapping/statements/excluded_types.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/objects_of_class.hpp"

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

/// Whether the rule may give the class itself: it names it, and makes types.
bool mayDerive(const mapping::NamedText& rule, const std::string& class_iri) {
  const mapping::RuleShape shape = mapping::shapeOf(rule);
  const std::string type = rdf::vocabulary::rdf("type");
  bool by_variable = false;
  for (const sparql::ast::TriplePattern& made : shape.query.construct_template) {
    if (made.predicate.isVariable() || made.predicate.term().text != type) continue;
    if (!made.object.isVariable() && made.object.term().text == class_iri) return true;
    by_variable = by_variable || made.object.isVariable();
  }
  // A variable takes the class from an expression, where it is written in full or with a prefix.
  if (!by_variable) return false;
  const std::string local = ":" + mapping::localName(class_iri);
  for (std::size_t at = rule.text.find(local); at != std::string::npos; at = rule.text.find(local, at + 1)) {
    const std::size_t end = at + local.size();
    if (end == rule.text.size() ||
        (std::isalnum(static_cast<unsigned char>(rule.text[end])) == 0 && rule.text[end] != '_'))
      return true;
  }
  return rule.text.find("<" + class_iri + ">") != std::string::npos;
}

bool isRuledOut(const rdf::QuadReader& quads, const ContentHash& object, const std::string& class_iri) {
  const auto subject = quads.idOf(Term::iri(rdf::iriOfObject(object)));
  const auto type = quads.idOf(Term::iri(rdf::vocabulary::rdf("type")));
  const auto class_id = quads.idOf(Term::iri(class_iri));
  if (!subject || !type || !class_id) return false;
  const std::vector<rdf::Triple> excluded = mapping::excludedTypes(quads);
  return std::binary_search(excluded.begin(), excluded.end(), rdf::Triple{*subject, *type, *class_id});
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
    const std::vector<ContentHash> members = objectsOfClass(map.quads(), class_iri);
    const bool is_of_class = std::binary_search(members.begin(), members.end(), *object);
    json["is_of_class"] = is_of_class;
    text = derivedClassesText(map, rules, *object, json);
    if (is_of_class) return "it is " + name + " already\n" + text;
    if (isRuledOut(map.quads(), *object, class_iri))
      text += "an operator statement rules out that a SPARQL rule says " + name + "\n";
  }
  for (const mapping::NamedText& rule : inputs.sparql_rules)
    if (object && mayDerive(rule, class_iri)) {
      const std::string file = mapping::ruleFileName(rule);
      json["sparql_rules"].push_back(file);
      text += "SPARQL rule " + file + " can say " + name + " of an object, and does not of this one\n";
    }
  return text;
}

}  // namespace cluxel::tasks
