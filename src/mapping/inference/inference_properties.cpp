// SPDX-License-Identifier: Apache-2.0
// Collected from the axioms, the patterns and templates of rules, and the records of derivations.
#include "mapping/inference/inference_properties.hpp"

#include "mapping/inference/rule_evaluation.hpp"

namespace cluxel::mapping {

namespace {

void add(const rdf::QuadReader& reader, const Term& property, std::unordered_set<rdf::TermId>& ids) {
  if (const auto id = reader.idOf(property)) ids.insert(*id);
}

}  // namespace

InferenceProperties::InferenceProperties(const rdf::QuadReader& reader, const rdf::SchemaWords& words,
                                         const rdf::Schema& schema, const std::vector<RuleShape>& rules) {
  addAxioms(words, schema);
  for (const std::string& property : propertiesOfDerivations()) add(reader, Term::iri(property), inferred_);
  for (const RuleShape& rule : rules) addRule(reader, rule);
}

PropertyUse InferenceProperties::useOf(rdf::TermId property) const {
  if (all_inferred_ || inferred_.contains(property)) return PropertyUse::Inferred;
  return read_.contains(property) ? PropertyUse::Read : PropertyUse::None;
}

void InferenceProperties::addAxioms(const rdf::SchemaWords& words, const rdf::Schema& schema) {
  inferred_ = {words.type, words.sub_class, words.sub_property, words.inverse};
  inferred_.insert(schema.transitive.begin(), schema.transitive.end());
  for (const auto& [property, implied] : schema.implications) {
    inferred_.insert(property);
    for (const rdf::Implied& next : implied) inferred_.insert(next.property);
  }
}

void InferenceProperties::addRule(const rdf::QuadReader& reader, const RuleShape& rule) {
  all_inferred_ = all_inferred_ || rule.following == RuleShape::Following::Never;
  for (const ReadPattern& read : rule.reads) {
    for (const Term& link : read.links) add(reader, link, read_);
    if (!read.triple.isPath()) add(reader, read.triple.predicate.term(), read_);
  }
  for (const ast::TriplePattern& triple : rule.query.construct_template) {
    all_inferred_ = all_inferred_ || triple.predicate.isVariable();
    if (!triple.predicate.isVariable()) add(reader, triple.predicate.term(), inferred_);
  }
}

}  // namespace cluxel::mapping
