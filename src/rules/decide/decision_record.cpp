// SPDX-License-Identifier: Apache-2.0
// Describes seeds, leaves and what would have happened on the other side of a branch.
#include "rules/decide/decision_record.hpp"

#include <algorithm>

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
    if (isProbed(verdict.decision)) verdict.decision.flips = flipsOf(seed, walk);
    verdict.decision.path = std::move(walk.path);
    verdict.decision.leaf = walk.leaf;
    verdict.members = membersOf(walk.bindings);
    describeOutcome(walk, verdict);
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

  std::vector<DecisionFlip> flipsOf(const Candidate& seed, const WalkResult& walk) const {
    std::vector<DecisionFlip> flips;
    for (const WalkedNode& walked : walk.walked) {
      const WalkResult other = walkTree(state_, rule_, seed, walked.node);
      DecisionFlip flip{walked.first_step, walked.step_count, walked.node, false, {}};
      const auto& leaf = rule_.nodes[other.leaf].what;
      if (const auto* reject = std::get_if<RejectLeaf>(&leaf)) flip.outcome = reject->reason;
      if (const auto* accept = std::get_if<AcceptLeaf>(&leaf)) {
        flip.accepted = true;
        flip.outcome = describeAccept(*accept);
      }
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
