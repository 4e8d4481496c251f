// SPDX-License-Identifier: Apache-2.0
// Earlier classes cannot take the thing's fragments. At the turn of the class its rules judge them, and make no object.
#include "rules/propose/consideration.hpp"

#include <algorithm>

#include "rules/decide/decision_record.hpp"
#include "rules/decide/reasoning_strata.hpp"
#include "rules/decide/seam_search.hpp"
#include "rules/objects/seed_groups.hpp"
#include "rules/propose/condition_eval.hpp"

namespace cluxel::rules {

namespace {

/// How many layers a rule sees beyond its seeds: one, and one more for each `find`, because it looks on from what it
/// found. A find among objects may come to things that are in no layer.
std::uint32_t layersSeenBy(const Rule& rule) {
  std::uint32_t seen = 1;
  for (const TreeNode& node : rule.nodes)
    if (const auto* find = std::get_if<FindNode>(&node.what)) {
      if (!find->object_class.empty()) return kNoLayer;
      ++seen;
    }
  return seen;
}

class Considering {
 public:
  Considering(ReasoningState& state, const std::string& class_iri,
              const std::vector<perception::PrimitiveIndex>& primitives)
      : state_(state), class_iri_(class_iri), primitives_(primitives) {
    setOwners(kUnknown);
  }

  /// To be called for all strata in their order.
  void decide(const std::vector<std::string>& stratum) {
    for (const std::string& decided : stratum) {
      if (!state_.rules.catalogue.isA(decided, class_iri_)) continue;
      setOwners(kFree);
      for (const Rule& rule : state_.rules.rules)
        if (rule.class_iri == decided) by(rule);
      setOwners(kUnknown);
    }
    decideStratum(state_, stratum);
  }

  std::vector<Consideration> take() { return std::move(said_); }

  /// The last layer that the rules have looked at.
  std::uint32_t lastSeen(const std::vector<std::uint32_t>& layers) const {
    std::uint32_t last = 0;
    for (const auto& [primitive, beyond] : seen_from_) {
      const std::uint32_t own = layers[primitive];
      last = std::max(last, own == kNoLayer || beyond == kNoLayer ? kNoLayer : own + beyond);
    }
    return last;
  }

 private:
  void setOwners(OwnerIndex owner) {
    for (const perception::PrimitiveIndex primitive : primitives_)
      for (const FragmentIndex fragment : state_.fragments.fragmentsOf(primitive)) state_.setOwner(fragment, owner);
  }

  /// What the rule says makes no difference to others: it leaves no traces.
  void by(const Rule& rule) {
    const TraceRecorder traces = state_.trace;
    const std::size_t before = said_.size();
    SliceScope scope(state_, rule);
    for (const auto& group : seedGroups(state_, rule, scope.slices()))
      if (std::any_of(group.begin(), group.end(), [this](FragmentIndex fragment) { return isOurs(fragment); })) {
        Verdict verdict = judge(state_, rule, group);
        for (const FragmentIndex fragment : group)
          seen_from_.emplace_back(state_.fragments[fragment].primitive, layersSeenBy(rule));
        for (const perception::PrimitiveIndex member : verdict.members) seen_from_.emplace_back(member, 1);
        said_.push_back({std::move(verdict.decision), true, true});
      }
    scope.putBack();
    state_.trace.takeBack(traces);
    if (said_.size() > before) return;
    for (const perception::PrimitiveIndex primitive : primitives_) {
      said_.push_back(asNoSeed(rule, primitive));
      seen_from_.emplace_back(primitive, 1);
    }
  }

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
  const std::string& class_iri_;
  const std::vector<perception::PrimitiveIndex>& primitives_;
  std::vector<Consideration> said_;
  std::vector<std::pair<perception::PrimitiveIndex, std::uint32_t>> seen_from_;  ///< and how many layers farther
};

std::vector<perception::PrimitiveIndex> primitivesUpTo(std::uint32_t layer, const std::vector<std::uint32_t>& layers) {
  std::vector<perception::PrimitiveIndex> primitives;
  for (perception::PrimitiveIndex i = 0; i < layers.size(); ++i)
    if (layers[i] <= layer) primitives.push_back(i);
  return primitives;
}

}  // namespace

std::vector<Consideration> considerFor(const perception::Scene& scene, const RuleSet& rules,
                                       const ReasoningContext& context, const std::string& class_iri,
                                       const std::vector<perception::PrimitiveIndex>& primitives) {
  ReasoningContext probing = context;
  probing.probes = primitives;
  ReasoningState state(scene, rules, probing);
  Considering considering(state, class_iri, primitives);
  for (const std::vector<std::string>& stratum : rules.strata) considering.decide(stratum);
  return considering.take();
}

std::optional<std::vector<Consideration>> considerIn(const LocalInput& window, const RuleSet& rules,
                                                     const ReasoningContext& context, const std::string& class_iri,
                                                     double reach_m) {
  std::vector<perception::PrimitiveIndex> primitives;
  for (perception::PrimitiveIndex i = 0; i < window.is_dirty.size(); ++i)
    if (window.is_dirty[i] != 0) primitives.push_back(i);
  ReasoningContext probing = context;
  probing.probes = primitives;
  ReasoningState state(window.window, rules, probing);
  Considering considering(state, class_iri, primitives);
  const DividedStrata strata = dividedStrata(rules);
  for (const std::vector<std::string>& stratum : strata.lone) considering.decide(stratum);
  const std::vector<char> is_fixed = fixedPrimitives(state);
  SeamSearch seam(window, is_fixed, reach_m,
                  layersAround(window.window, window.is_dirty, is_fixed, window.gone, reach_m));
  if (!seam.isInWindow()) return std::nullopt;
  state.trace.keepMembers();
  for (const std::vector<std::string>& stratum : strata.later) considering.decide(stratum);
  const ReasoningResult result = finishedRun(state);
  if (!seam.find(result.traces, state.trace.steps())) return std::nullopt;
  // Within a seam, too, all is in the state in which it would be in the run over the whole. A layer more that counts as
  // changed brings all that was seen a layer nearer.
  constexpr int kMostLayers = 20;  // a rule that looks for objects sees things in no layer
  std::uint32_t seen = considering.lastSeen(seam.layers());
  for (int layer = 0; seen > kLastLayer; ++layer) {
    if (layer == kMostLayers || !seam.addChanged(primitivesUpTo(1, seam.layers())) ||
        !seam.find(result.traces, state.trace.steps()))
      return std::nullopt;
    seen = std::min(seen == kNoLayer ? kNoLayer : seen - 1, considering.lastSeen(seam.layers()));
  }
  return considering.take();
}

}  // namespace cluxel::rules
