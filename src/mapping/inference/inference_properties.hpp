// SPDX-License-Identifier: Apache-2.0
// Which properties inference uses. Most facts that a scan changes are measurements, which inference does not use.
#pragma once

#include <cstdint>
#include <unordered_set>
#include <vector>

#include "mapping/inference/rule_shape.hpp"
#include "rdf/ontology/schema.hpp"

namespace cluxel::mapping {

/// What inference does with the facts of a property.
enum class PropertyUse : std::uint8_t {
  None,     ///< a fact is known when it is stated, and nothing follows from it
  Read,     ///< a fact is known when it is stated, and rules read it
  Inferred  ///< the closure or a rule derives facts of it, or the closure derives others from them
};

class InferenceProperties {
 public:
  /// Expects that all shapes tell what their rules read.
  InferenceProperties(const rdf::QuadReader& reader, const rdf::SchemaWords& words, const rdf::Schema& schema,
                      const std::vector<RuleShape>& rules);

  PropertyUse useOf(rdf::TermId property) const;

 private:
  void addAxioms(const rdf::SchemaWords& words, const rdf::Schema& schema);
  void addRule(const rdf::QuadReader& reader, const RuleShape& rule);

  std::unordered_set<rdf::TermId> read_, inferred_;
  bool all_inferred_ = false;
};

}  // namespace cluxel::mapping
