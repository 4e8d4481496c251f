// SPDX-License-Identifier: Apache-2.0
// The properties that inference has to do with. Most facts that a scan changes are measurements of others.
#pragma once

#include <unordered_set>
#include <vector>

#include "mapping/inference/rule_shape.hpp"
#include "rdf/ontology/schema.hpp"

namespace cluxel::mapping {

class InferenceProperties {
 public:
  /// Expects that all shapes tell what their rules read.
  InferenceProperties(const rdf::QuadReader& reader, const rdf::SchemaWords& words, const rdf::Schema& schema,
                      const std::vector<RuleShape>& rules);

  /// Whether the closure or a rule reads or derives facts of the property. Of another property, a fact is known when
  /// it is stated, and nothing follows from it.
  bool contains(rdf::TermId property) const { return has_all_ || ids_.contains(property); }

 private:
  void addAxioms(const rdf::SchemaWords& words, const rdf::Schema& schema);
  void addRule(const rdf::QuadReader& reader, const RuleShape& rule);
  void add(const rdf::QuadReader& reader, const Term& property);

  std::unordered_set<rdf::TermId> ids_;
  bool has_all_ = false;
};

}  // namespace cluxel::mapping
