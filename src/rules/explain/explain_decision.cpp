// SPDX-License-Identifier: Apache-2.0
// Runs the reasoning stage with a probe and collects the decisions about one primitive.
#include "rules/explain/explain.hpp"

#include <algorithm>

#include "rules/explain/counterfactuals.hpp"

namespace cluxel::rules {

namespace {

std::optional<Counterfactual> nearestCounterfactual(const Decision& decision, const Rule& rule) {
  std::optional<Counterfactual> best;
  for (const DecisionFlip& flip : decision.flips) {
    if (flip.accepted == decision.accepted) continue;
    const auto* branch = std::get_if<BranchNode>(&rule.nodes[flip.node].what);
    if (branch == nullptr) continue;  // a find cannot be flipped by changing one measured value
    auto changes = counterfactualChanges(branch->condition, decision.path, flip.step);
    if (!changes || (best && costOf(*changes) >= costOf(best->changes))) continue;
    best = Counterfactual{std::move(*changes), flip.accepted, flip.outcome};
  }
  return best;
}

bool owns(const SemanticObject& object, perception::PrimitiveIndex primitive) {
  return std::any_of(object.parts.begin(), object.parts.end(), [&](const ObjectPart& part) {
    return std::binary_search(part.primitives.begin(), part.primitives.end(), primitive);
  });
}

}  // namespace

Explanation explain(const perception::Scene& scene, const RuleSet& rules, const ReasoningContext& context,
                    perception::PrimitiveIndex primitive) {
  ReasoningContext probing = context;
  probing.probe = primitive;
  const ReasoningResult result = reason(scene, rules, probing);
  Explanation explanation;
  explanation.primitive = primitive;
  for (const SemanticObject& object : result.objects)
    if (!explanation.object && owns(object, primitive)) explanation.object = object;
  bool decided = false;
  for (const Decision& decision : result.decisions) {
    if (!std::binary_search(decision.seeds.begin(), decision.seeds.end(), primitive)) continue;
    const Rule* rule = rules.find(decision.rule_id);
    explanation.decisions.push_back({decision, rule->class_iri, nearestCounterfactual(decision, *rule)});
    decided = decided || decision.accepted;
  }
  if (explanation.object && !decided) {
    const Decision& decision = result.decisions[explanation.object->decision];
    explanation.decisions.push_back({decision, explanation.object->class_iri, std::nullopt});
    explanation.note = "it was found or absorbed by the object that grew from another primitive";
  }
  return explanation;
}

Explanation explain(const perception::Scene& scene, const RuleSet& rules, const ReasoningContext& context,
                    const SemanticObject& object, const Decision& decision) {
  Explanation explanation = explain(scene, rules, context, decision.seed);
  const bool same = explanation.object && explanation.object->id == object.id;
  if (!same && owns(object, decision.seed)) explanation.object = object;
  return explanation;
}

}  // namespace cluxel::rules
