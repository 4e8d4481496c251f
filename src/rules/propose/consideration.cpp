// SPDX-License-Identifier: Apache-2.0
// Earlier classes cannot take the thing's fragments. At the turn of the class its rules judge them, and make no object.
#include "rules/propose/consideration.hpp"

#include <algorithm>

#include "rules/decide/decision_record.hpp"
#include "rules/decide/reasoning_strata.hpp"
#include "rules/objects/seed_groups.hpp"
#include "rules/propose/condition_eval.hpp"

namespace cluxel::rules {

namespace {

class Considering {
 public:
  Considering(ReasoningState& state, const std::vector<perception::PrimitiveIndex>& primitives)
      : state_(state), primitives_(primitives) {}

  void setOwners(OwnerIndex owner) {
    for (const perception::PrimitiveIndex primitive : primitives_)
      for (const FragmentIndex fragment : state_.fragments.fragmentsOf(primitive)) state_.setOwner(fragment, owner);
  }

  void by(const Rule& rule, std::vector<Consideration>& said) {
    const std::size_t before = said.size();
    SliceScope scope(state_, rule);
    for (const auto& group : seedGroups(state_, rule, scope.slices()))
      if (std::any_of(group.begin(), group.end(), [this](FragmentIndex fragment) { return isOurs(fragment); }))
        said.push_back({judge(state_, rule, group).decision, true, true});
    scope.putBack();
    if (said.size() > before) return;
    for (const perception::PrimitiveIndex primitive : primitives_) said.push_back(asNoSeed(rule, primitive));
  }

 private:
  bool isOurs(FragmentIndex fragment) const {
    return std::find(primitives_.begin(), primitives_.end(), state_.fragments[fragment].primitive) != primitives_.end();
  }

  Consideration asNoSeed(const Rule& rule, perception::PrimitiveIndex primitive) const {
    Consideration said;
    said.decision.rule_id = rule.id;
    said.decision.seed = primitive;
    said.decision.seeds = {primitive};
    const auto label = state_.scene.primitives[primitive].label;
    said.has_label = std::find(rule.seed.labels.begin(), rule.seed.labels.end(), label) != rule.seed.labels.end();
    said.decision.reason =
        said.has_label ? "it is no seed of the rule" : "the rule does not begin with " + withArticle(nameOf(label));
    Bindings bindings;
    bindings.candidates.emplace_back(rule.seed.name,
                                     state_.fragments.candidateOf(state_.fragments.fragmentsOf(primitive)));
    ConditionEvaluator evaluator(state_, rule, bindings);
    for (const Condition& condition : rule.seed.where) evaluator.holds(condition, &said.decision.path);
    return said;
  }

  ReasoningState& state_;
  const std::vector<perception::PrimitiveIndex>& primitives_;
};

}  // namespace

std::vector<Consideration> considerFor(const perception::Scene& scene, const RuleSet& rules,
                                       const ReasoningContext& context, const std::string& class_iri,
                                       const std::vector<perception::PrimitiveIndex>& primitives) {
  ReasoningContext probing = context;
  probing.probes = primitives;
  ReasoningState state(scene, rules, probing);
  Considering considering(state, primitives);
  std::vector<Consideration> said;
  considering.setOwners(kUnknown);
  for (const std::vector<std::string>& stratum : rules.strata) {
    for (const std::string& decided : stratum) {
      if (!rules.catalogue.isA(decided, class_iri)) continue;
      considering.setOwners(kFree);
      for (const Rule& rule : rules.rules)
        if (rule.class_iri == decided) considering.by(rule, said);
      considering.setOwners(kUnknown);
    }
    decideStratum(state, stratum);
  }
  return said;
}

}  // namespace cluxel::rules
