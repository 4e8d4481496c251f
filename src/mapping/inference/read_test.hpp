// SPDX-License-Identifier: Apache-2.0
// Tells whether a fact matches a pattern of a rule.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "mapping/inference/rule_shape.hpp"
#include "rdf/ontology/staged_facts.hpp"

namespace cluxel::mapping {

class ReadTest {
 public:
  ReadTest(const rdf::QuadReader& reader, const RuleShape& shape);

  bool matches(const rdf::Triple& fact) const;
  /// Whether the fact matches one pattern, by its number in RuleShape::reads.
  bool matches(std::size_t read, const rdf::Triple& fact) const;
  /// The properties of all patterns that a fact can match.
  const std::set<rdf::TermId>& properties() const { return properties_; }
  /// What matches a pattern that is not a path, with kNoTerm for variables. None when the store lacks a term of it.
  std::optional<rdf::Triple> patternOf(std::size_t read) const;
  /// The properties that the path of a pattern walks.
  std::vector<rdf::TermId> linksOf(std::size_t read) const;

 private:
  /// kNoTerm is any term; one that the store does not have matches nothing and is left out.
  std::vector<std::vector<rdf::Triple>> patterns_;
  std::set<rdf::TermId> properties_;
};

}  // namespace cluxel::mapping
