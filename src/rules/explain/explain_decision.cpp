// SPDX-License-Identifier: Apache-2.0
// Runs the reasoning stage with a probe and collects the decisions about one primitive.
#include "rules/explain/explain.hpp"

#include <algorithm>
#include <map>

#include "rules/explain/counterfactuals.hpp"

namespace cluxel::rules {

namespace {

std::optional<Counterfactual> nearestCounterfactual(const Decision& decision) {
  std::optional<Counterfactual> best;
  for (const DecisionFlip& flip : decision.flips) {
    if (flip.accepted == decision.accepted) continue;  // what lost to a rival is not reversed by a rejection
    if (best && costOf(flip.changes) >= costOf(best->changes)) continue;
    best = Counterfactual{flip.changes, flip.accepted, flip.outcome};
  }
  return best;
}

bool owns(const SemanticObject& object, perception::PrimitiveIndex primitive) {
  return std::any_of(object.parts.begin(), object.parts.end(), [&](const ObjectPart& part) {
    return std::binary_search(part.primitives.begin(), part.primitives.end(), primitive);
  });
}

/// The decisions about each of some primitives, as numbers in ReasoningResult::decisions.
using DecisionsOf = std::map<perception::PrimitiveIndex, std::vector<std::size_t>>;

DecisionsOf decisionsAbout(const std::vector<perception::PrimitiveIndex>& primitives, const ReasoningResult& result) {
  DecisionsOf decisions;
  for (const perception::PrimitiveIndex primitive : primitives) decisions[primitive];
  for (std::size_t i = 0; i < result.decisions.size(); ++i)
    for (const perception::PrimitiveIndex seed : result.decisions[i].seeds)
      if (const auto known = decisions.find(seed); known != decisions.end()) known->second.push_back(i);
  return decisions;
}

Explanation explanationOf(perception::PrimitiveIndex primitive, const std::vector<std::size_t>& decisions,
                          const SemanticObject* object, const ReasoningResult& result, const RuleSet& rules) {
  Explanation explanation;
  explanation.primitive = primitive;
  if (object != nullptr) explanation.object = *object;
  bool decided = false;
  for (const std::size_t i : decisions) {
    const Decision& decision = result.decisions[i];
    const Rule* rule = rules.find(decision.rule_id);
    explanation.decisions.push_back({decision, rule->class_iri, nearestCounterfactual(decision)});
    decided = decided || decision.accepted;
  }
  if (explanation.object && !decided) {
    const Decision& decision = result.decisions[explanation.object->decision];
    explanation.decisions.push_back({decision, explanation.object->class_iri, std::nullopt});
    explanation.note = "it was found or absorbed by the object that grew from another primitive";
  }
  return explanation;
}

}  // namespace

Explanation explanationIn(const ReasoningResult& result, const RuleSet& rules, perception::PrimitiveIndex primitive) {
  const auto owner = std::find_if(result.objects.begin(), result.objects.end(),
                                  [primitive](const SemanticObject& object) { return owns(object, primitive); });
  return explanationOf(primitive, decisionsAbout({primitive}, result).at(primitive),
                       owner == result.objects.end() ? nullptr : &*owner, result, rules);
}

std::optional<Explanation> explanationIn(const ReasoningResult& result, const RuleSet& rules,
                                         const ContentHash& object) {
  const auto made = std::find_if(result.objects.begin(), result.objects.end(),
                                 [&](const SemanticObject& candidate) { return candidate.id == object; });
  if (made == result.objects.end()) return std::nullopt;
  const perception::PrimitiveIndex seed = result.decisions.at(made->decision).seed;
  return explanationOf(seed, decisionsAbout({seed}, result).at(seed), &*made, result, rules);
}

std::vector<perception::PrimitiveIndex> primitivesOf(const SemanticObject& object) {
  std::vector<perception::PrimitiveIndex> primitives;
  for (const ObjectPart& part : object.parts)
    primitives.insert(primitives.end(), part.primitives.begin(), part.primitives.end());
  std::sort(primitives.begin(), primitives.end());
  primitives.erase(std::unique(primitives.begin(), primitives.end()), primitives.end());
  return primitives;
}

Explanation explain(const perception::Scene& scene, const RuleSet& rules, const ReasoningContext& context,
                    perception::PrimitiveIndex primitive) {
  ReasoningContext probing = context;
  probing.probes = {primitive};
  return explanationIn(reason(scene, rules, probing), rules, primitive);
}

std::optional<Explanation> explain(const perception::Scene& scene, const RuleSet& rules,
                                   const ReasoningContext& context, const SemanticObject& known) {
  ReasoningContext probing = context;
  probing.probes = primitivesOf(known);
  return explanationIn(reason(scene, rules, probing), rules, known.id);
}

std::vector<Explanation> explainAll(const perception::Scene& scene, const RuleSet& rules,
                                    const ReasoningContext& context, const ReasoningResult& result,
                                    const std::map<ContentHash, perception::PrimitiveIndex>& samples) {
  const auto placeOf = [&samples](const SemanticObject& object, const ReasoningResult& made) {
    const auto sample = samples.find(object.id);
    return sample != samples.end() ? sample->second : made.decisions.at(object.decision).seed;
  };
  ReasoningContext probing = context;
  for (const SemanticObject& object : result.objects) probing.probes.push_back(placeOf(object, result));
  std::sort(probing.probes.begin(), probing.probes.end());
  const ReasoningResult probed = reason(scene, rules, probing);
  const DecisionsOf decisions = decisionsAbout(probing.probes, probed);
  std::vector<Explanation> explanations;
  explanations.reserve(probed.objects.size());
  for (const SemanticObject& object : probed.objects) {
    const perception::PrimitiveIndex place = placeOf(object, probed);
    explanations.push_back(explanationOf(place, decisions.at(place), &object, probed, rules));
  }
  return explanations;
}

}  // namespace cluxel::rules
