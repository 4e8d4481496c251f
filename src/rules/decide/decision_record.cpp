// SPDX-License-Identifier: Apache-2.0
// Describes seeds, leaves and what would have happened on the other side of a branch.
#include "rules/decide/decision_record.hpp"

#include <algorithm>
#include <cmath>

#include "rules/explain/changed_values.hpp"
#include "rules/explain/counterfactuals.hpp"
#include "rules/propose/condition_eval.hpp"
#include "rules/propose/evidence.hpp"

namespace cluxel::rules {

namespace {

constexpr double kNotMeasured = -1e300;

class Judging {
 public:
  Judging(const ReasoningState& state, const Rule& rule) : state_(state), rule_(rule) {}

  Verdict about(const std::vector<FragmentIndex>& group) const {
    const Candidate seed = state_.fragments.candidateOf(group);
    WalkResult walk = walkTree(state_, rule_, seed);
    Verdict verdict;
    verdict.decision = describeSeed(seed);
    verdict.decision.leaf = walk.leaf;
    verdict.members = membersOf(walk.bindings);
    describeOutcome(walk, verdict);
    if (isProbed(verdict.decision)) verdict.decision.flips = flipsOf(seed, walk, verdict);
    verdict.decision.path = std::move(walk.path);
    verdict.bindings = std::move(walk.bindings);
    verdict.related = walk.related;
    verdict.trace = traceOf(verdict);
    if (!state_.context.keeps_paths) verdict.decision.path = {}, verdict.decision.evidence = {};
    return verdict;
  }

 private:
  void describeOutcome(const WalkResult& walk, Verdict& verdict) const {
    const TreeNode& leaf = rule_.nodes[walk.leaf];
    if (const auto* reject = std::get_if<RejectLeaf>(&leaf.what)) {
      if (state_.context.keeps_paths) {
        verdict.decision.reason = reject->reason;
        verdict.decision.hint = reject->hint;
      }
      verdict.leaves_unknown = reject->leave_unknown;
      return;
    }
    verdict.accept = &std::get<AcceptLeaf>(leaf.what);
    verdict.decision.accepted = true;
    if (state_.context.keeps_paths) verdict.decision.reason = describeAccept(*verdict.accept);
    weigh(state_, rule_, *verdict.accept, walk.bindings, verdict.decision);
  }

  std::vector<perception::PrimitiveIndex> membersOf(const Bindings& bindings) const {
    std::vector<perception::PrimitiveIndex> members;
    for (const auto& [name, candidate] : bindings.candidates)
      for (const FragmentIndex fragment : candidate.fragments) members.push_back(state_.fragments[fragment].primitive);
    std::sort(members.begin(), members.end());
    members.erase(std::unique(members.begin(), members.end()), members.end());
    return members;
  }

  std::uint64_t traceOf(const Verdict& verdict) const {
    const Decision& decision = verdict.decision;
    std::uint64_t trace = mixed(hashOf(rule_.id), std::uint64_t{decision.leaf});
    for (const auto& [name, candidate] : verdict.bindings.candidates)
      trace = mixed(trace, state_.fragments.hashOf(candidate.fragments));
    for (const DecisionStep& step : decision.path) {
      trace = mixed(trace, tracedMeasure(step));
      if (step.other) trace = mixed(trace, *step.other);
    }
    for (const EvidenceStep& step : decision.evidence)
      trace = mixed(mixed(trace, step.measured.value_or(kNotMeasured)), step.log_odds);
    return mixed(StepKind::Judged, trace);
  }

  /// What is found whatever the thresholds are: they may change without a difference. How the tests ended is told by
  /// the leaf.
  static double tracedMeasure(const DecisionStep& step) {
    const bool is_found = step.measured && (!step.is_looked_for || *step.measured <= kMeasureMargin_m);
    return is_found ? *step.measured : kNotMeasured;
  }

  Decision describeSeed(const Candidate& seed) const {
    Decision decision;
    decision.rule_id = rule_.id;
    std::optional<FragmentIndex> largest;
    for (FragmentIndex fragment : seed.fragments) {
      decision.seeds.push_back(state_.fragments[fragment].primitive);
      const double points = state_.fragments.shapeOf(fragment).points;
      const bool larger =
          !largest || points > state_.fragments.shapeOf(*largest).points ||
          (points == state_.fragments.shapeOf(*largest).points && state_.fragments.before(fragment, *largest));
      if (larger) largest = fragment;
    }
    decision.seed = state_.fragments[*largest].primitive;
    std::sort(decision.seeds.begin(), decision.seeds.end());
    decision.seeds.erase(std::unique(decision.seeds.begin(), decision.seeds.end()), decision.seeds.end());
    return decision;
  }

  bool isProbed(const Decision& decision) const {
    const std::vector<perception::PrimitiveIndex>& probes = state_.context.probes;
    return std::any_of(decision.seeds.begin(), decision.seeds.end(), [&probes](perception::PrimitiveIndex seed) {
      return std::binary_search(probes.begin(), probes.end(), seed);
    });
  }

  std::string describeAccept(const AcceptLeaf& accept) const {
    std::string text = state_.rules.shorten(rule_.class_iri);
    for (const auto& [name, part] : accept.parts)
      if (part != rule_.class_iri)
        text += (&accept.parts.front().second == &part ? ": " : ", ") + name + " is " + state_.rules.shorten(part);
    return text;
  }

  /// Rivals are left aside: they are asked when all candidates are known.
  bool isAgainstEvidence(const AcceptLeaf& accept, const Bindings& bindings, double log_odds) const {
    const auto& strata = state_.rules.strata;
    const bool competes = !rule_.leftovers && std::any_of(strata.begin(), strata.end(), [this](const auto& stratum) {
      return stratum.size() > 1 && std::find(stratum.begin(), stratum.end(), rule_.class_iri) != stratum.end();
    });
    return competes ? logOddsOfNothing(state_, accept, bindings).scoreOf(log_odds) <= 0 : log_odds <= kMinLogOdds;
  }

  /// Whether a seed of one fragment is still one with the changed values. Seeds are chosen one by one, before they are
  /// grouped and measured together.
  bool isSeed(const Candidate& seed, const ChangedValues& changed) const {
    if (seed.fragments.size() > 1) return true;
    Bindings bindings;
    bindings.candidates.emplace_back(rule_.seed.name, seed);
    if (!ConditionEvaluator(state_, rule_, bindings).allHold(rule_.seed.where)) return true;  // it was grown into one
    bindings.changed = &changed;
    return ConditionEvaluator(state_, rule_, bindings).allHold(rule_.seed.where);
  }

  DecisionFlip verdictWith(const Candidate& seed, const ChangedValues& changed) const {
    DecisionFlip verdict;
    verdict.outcome = "it is no seed of the rule";
    if (!isSeed(seed, changed)) return verdict;
    const WalkResult walk = walkTree(state_, rule_, seed, &changed);
    const auto& leaf = rule_.nodes[walk.leaf].what;
    if (const auto* reject = std::get_if<RejectLeaf>(&leaf)) {
      verdict.outcome = reject->reason;
      return verdict;
    }
    const auto& accept = std::get<AcceptLeaf>(leaf);
    Decision weighed;
    weigh(state_, rule_, accept, walk.bindings, weighed);
    verdict.accepted = !isAgainstEvidence(accept, walk.bindings, weighed.log_odds);
    verdict.outcome = verdict.accepted ? describeAccept(accept) : kAgainstEvidence;
    return verdict;
  }

  /// One for each branch of the path, as far as the rule would then say the opposite. A find is turned by no value.
  std::vector<DecisionFlip> flipsOf(const Candidate& seed, const WalkResult& walk, const Verdict& verdict) const {
    const bool accepts =
        verdict.accept != nullptr && !isAgainstEvidence(*verdict.accept, walk.bindings, verdict.decision.log_odds);
    std::vector<DecisionFlip> flips;
    for (const WalkedNode& walked : walk.walked) {
      const auto* branch = std::get_if<BranchNode>(&rule_.nodes[walked.node].what);
      const auto turns = branch ? leastTurns(branch->condition, walk.path, walked.first_step) : std::nullopt;
      if (!turns) continue;
      ChangedValues changed;
      for (const TurnedTest& turn : *turns) changed.set(*turn.test, walk.bindings, turn.measured, turn.value);
      DecisionFlip flip = verdictWith(seed, changed);
      if (flip.accepted == accepts) continue;
      for (const TurnedTest& turn : *turns) flip.changes.push_back(turn.change);
      flips.push_back(std::move(flip));
    }
    return flips;
  }

  const ReasoningState& state_;
  const Rule& rule_;
};

}  // namespace

Verdict judge(const ReasoningState& state, const Rule& rule, const std::vector<FragmentIndex>& group) {
  return Judging(state, rule).about(group);
}

std::int64_t LogOddsOfNothing::scoreOf(double log_odds) const {
  return log_odds > as_one ? std::llround((log_odds - sum) * 1e6) : 0;
}

LogOddsOfNothing logOddsOfNothing(const ReasoningState& state, const AcceptLeaf& accept, const Bindings& bindings) {
  double sum = 0, weighted = 0, points = 0;
  for (const auto& [name, part_class] : accept.parts) {
    if (accept.splitting && accept.splitting->part == name) continue;
    for (FragmentIndex fragment : bindings.at(name).fragments) {
      if (state.fragments[fragment].owner != kFree) continue;
      const double of_label = state.rules.nothing[static_cast<std::size_t>(state.fragments.labelOf(fragment))];
      const double own = state.fragments.shapeOf(fragment).points;
      sum += of_label, weighted += own * of_label, points += own;
    }
  }
  return {sum, points > 0 ? weighted / points : 0};
}

}  // namespace cluxel::rules
