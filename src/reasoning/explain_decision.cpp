// SPDX-License-Identifier: Apache-2.0
// Reads an explanation out of the decisions of a probed run.
#include "cluxel/reasoning/explain.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cluxel {

namespace {

/// The change that one step needs; absent when it measured nothing that could change.
std::optional<NeededChange> changeOf(const DecisionStep& step) {
  if (!step.measured || !step.threshold) return std::nullopt;
  const double scale = step.unit == "rad" ? 180.0 / std::numbers::pi : 1.0;
  NeededChange change;
  change.test = step.test;
  change.measured = *step.measured * scale;
  change.threshold = *step.threshold * scale;
  change.unit = step.unit == "rad" ? "deg" : step.unit;
  change.margin = std::abs(change.measured - change.threshold);
  return change;
}

/// How large a change is beside the threshold: to compare metres with degrees.
double costOf(const std::vector<NeededChange>& changes) {
  double cost = 0;
  for (const NeededChange& change : changes) cost += change.margin / std::max(std::abs(change.threshold), 0.05);
  return cost;
}

/// What has to change for the tests of a flipped branch to come out otherwise. A branch of several tests that passed
/// turns when its closest test fails; one that failed turns when all failed tests pass (for `any`, this asks for more
/// than is needed).
std::vector<NeededChange> changesOf(const Decision& decision, const DecisionFlip& flip) {
  std::vector<NeededChange> failed, passed;
  for (std::size_t i = flip.step; i < flip.step + flip.step_count; ++i) {
    const auto change = changeOf(decision.path[i]);
    if (change) (decision.path[i].passed ? passed : failed).push_back(*change);
  }
  if (!failed.empty()) return failed;
  const auto closest = std::min_element(passed.begin(), passed.end(), [](const auto& a, const auto& b) {
    return costOf({a}) < costOf({b});
  });
  return closest == passed.end() ? std::vector<NeededChange>{} : std::vector<NeededChange>{*closest};
}

std::optional<TurningPoint> leastChange(const Decision& decision) {
  std::optional<TurningPoint> best;
  for (const DecisionFlip& flip : decision.flips) {
    if (flip.accepted == decision.accepted) continue;
    TurningPoint point{changesOf(decision, flip), flip.accepted, flip.outcome};
    if (point.changes.empty()) continue;
    if (!best || costOf(point.changes) < costOf(best->changes)) best = std::move(point);
  }
  return best;
}

bool owns(const SemanticObject& object, PrimitiveIndex primitive) {
  return std::any_of(object.parts.begin(), object.parts.end(), [&](const ObjectPart& part) {
    return std::binary_search(part.primitives.begin(), part.primitives.end(), primitive);
  });
}

}  // namespace

Explanation explain(const Scene& scene, const RuleSet& rules, const ReasoningContext& context,
                    PrimitiveIndex primitive) {
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
    explanation.decisions.push_back({decision, rule->class_iri, leastChange(decision)});
    decided = decided || decision.accepted;
  }
  if (explanation.object && !decided) {
    const Decision& decision = result.decisions[explanation.object->decision];
    explanation.decisions.push_back({decision, explanation.object->class_iri, std::nullopt});
    explanation.note = "it was found or absorbed by the object that grew from another primitive";
  }
  return explanation;
}

Explanation explain(const Scene& scene, const RuleSet& rules, const ReasoningContext& context,
                    const SemanticObject& object, const Decision& decision) {
  Explanation explanation = explain(scene, rules, context, decision.seed);
  const bool same = explanation.object && explanation.object->id == object.id;
  if (!same && owns(object, decision.seed)) explanation.object = object;
  return explanation;
}

}  // namespace cluxel
