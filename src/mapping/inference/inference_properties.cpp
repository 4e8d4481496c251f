// SPDX-License-Identifier: Apache-2.0
// Collected from the axioms, the patterns and templates of rules, and the records of derivations.
#include "mapping/inference/inference_properties.hpp"

#include "mapping/inference/rule_evaluation.hpp"

namespace cluxel::mapping {

InferenceProperties::InferenceProperties(const rdf::QuadReader& reader, const rdf::SchemaWords& words,
                                         const rdf::Schema& schema, const std::vector<RuleShape>& rules) {
  addAxioms(words, schema);
  for (const std::string& property : propertiesOfDerivations()) add(reader, Term::iri(property));
  for (const RuleShape& rule : rules) addRule(reader, rule);
}

void InferenceProperties::addAxioms(const rdf::SchemaWords& words, const rdf::Schema& schema) {
  ids_ = {words.type, words.sub_class, words.sub_property, words.inverse};
  ids_.insert(schema.transitive.begin(), schema.transitive.end());
  for (const auto& [property, implied] : schema.implications) {
    ids_.insert(property);
    for (const rdf::Implied& next : implied) ids_.insert(next.property);
  }
}

void InferenceProperties::addRule(const rdf::QuadReader& reader, const RuleShape& rule) {
  has_all_ = has_all_ || rule.following == RuleShape::Following::Never;
  for (const ReadPattern& read : rule.reads) {
    for (const Term& link : read.links) add(reader, link);
    if (!read.triple.isPath()) add(reader, read.triple.predicate.term());
  }
  for (const ast::TriplePattern& triple : rule.query.construct_template) {
    has_all_ = has_all_ || triple.predicate.isVariable();
    if (!triple.predicate.isVariable()) add(reader, triple.predicate.term());
  }
}

void InferenceProperties::add(const rdf::QuadReader& reader, const Term& property) {
  if (const auto id = reader.idOf(property)) ids_.insert(*id);
}

}  // namespace cluxel::mapping
