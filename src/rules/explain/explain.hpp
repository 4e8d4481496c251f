// SPDX-License-Identifier: Apache-2.0
// Explains why a primitive has its class, why not another one, and what would change that.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rules/decide/reason.hpp"

namespace cluxel::rules {

/// The smallest set of changes that flips a decision by flipping one branch of the tree.
struct Counterfactual {
  std::vector<NeededChange> changes;  ///< all of them are needed
  bool accepted = false;              ///< the verdict after the changes
  std::string outcome;
};

struct ExplainedDecision {
  Decision decision;
  std::string class_iri;
  std::optional<Counterfactual> counterfactual;  ///< changes the verdict; absent when no single branch can
};

struct Explanation {
  perception::PrimitiveIndex primitive = 0;
  std::optional<SemanticObject>
      object;  ///< the object it belongs to; for a split primitive the one with the smallest id
  std::vector<ExplainedDecision> decisions;  ///< about this primitive, in the order in which they were taken
  std::string note;  ///< set when it has no decision of its own because it was found or absorbed
};

/// Runs the reasoning stage again with a probe at the primitive.
Explanation explain(const perception::Scene& scene, const RuleSet& rules, const ReasoningContext& context,
                    perception::PrimitiveIndex primitive);

/// The same for the seed primitive of an object that an earlier run made: its id and parts are read. Absent when the
/// rules do not make it.
std::optional<Explanation> explain(const perception::Scene& scene, const RuleSet& rules,
                                   const ReasoningContext& context, const SemanticObject& known);

/// What a run with a probe at the primitive tells about it.
Explanation explanationIn(const ReasoningResult& result, const RuleSet& rules, perception::PrimitiveIndex primitive);
/// What a run with probes tells about an object; absent when the run did not make it.
std::optional<Explanation> explanationIn(const ReasoningResult& result, const RuleSet& rules,
                                         const ContentHash& object);

/// The primitives of an object, ascending.
std::vector<perception::PrimitiveIndex> primitivesOf(const SemanticObject& object);

/// The same for all objects of `result`, which reason() gave for the same scene, rules and context: one explanation for
/// each, in their order. `samples`: primitives at which objects are explained instead of at their seeds. Cost: one run
/// of the stage with a probe at every object.
std::vector<Explanation> explainAll(const perception::Scene& scene, const RuleSet& rules,
                                    const ReasoningContext& context, const ReasoningResult& result,
                                    const std::map<ContentHash, perception::PrimitiveIndex>& samples = {});

/// As text: the path to the verdict, then the path of each rejected class with its nearest counterfactual.
std::string textOf(const Explanation& explanation, const RuleSet& rules, const perception::Scene& scene);
std::string jsonOf(const Explanation& explanation, const RuleSet& rules, const perception::Scene& scene);

}  // namespace cluxel::rules
