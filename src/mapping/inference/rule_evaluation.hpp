// SPDX-License-Identifier: Apache-2.0
// Evaluates a SPARQL rule, or its solutions for some keys, into facts.
#pragma once

#include <compare>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/inference/rule_queries.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/ontology/staged_facts.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {

/// A fact that solutions of a rule with this key give. The key is kNoTerm for a rule that has none.
struct RuleOutput {
  rdf::TermId key = rdf::kNoTerm;
  rdf::Triple fact;
  auto operator<=>(const RuleOutput&) const = default;
};

using Outputs = std::vector<RuleOutput>;

sparql::QueryOptions ruleOptions(const NamedText& rule, const rdf::InferenceCheck& check = {});

/// Tells of a triple of a row whether the rule may see it.
using IsSeen = std::function<bool(const rdf::Triple& fact)>;

/// What the rule's solutions give, sorted and without duplicates; new terms are added to the store. `keys`: only those
/// with these keys. `is_seen`: of a plain rule, only rows of which all triples are seen.
std::vector<RuleOutput> evaluateRule(rdf::WriteTransaction& transaction, const RuleShape& shape,
                                     const rdf::InferenceCheck& check, const std::optional<ValuesOf>& keys = {},
                                     const IsSeen& is_seen = {});
/// Takes the outputs of some keys, or all, away and puts others in their place. Returns the facts of both.
std::vector<rdf::Triple> replaceOutputs(std::vector<RuleOutput>& outputs,
                                        const std::optional<std::vector<rdf::TermId>>& keys,
                                        const std::vector<RuleOutput>& now);
/// The keys of a superset of the solutions in which the variable has one of the values.
std::vector<rdf::TermId> affectedKeys(const rdf::QuadReader& reader, const RuleShape& shape, const ValuesOf& values,
                                      const rdf::InferenceCheck& check);

/// Begins the labels of derivations that are blank nodes.
inline constexpr std::string_view kBlankDerivation = "derivation";
bool isDerivation(const rdf::TermView& term);
/// The properties of the quads of derivationOf().
std::vector<std::string> propertiesOfDerivations();
/// The five quads of the resource that records the rule of a derived fact; new terms are added to the writer.
std::vector<rdf::Triple> derivationOf(const rdf::QuadReader& reader, rdf::QuadWriter& writer, const rdf::Triple& fact,
                                      const NamedText& rule);

}  // namespace cluxel::mapping
