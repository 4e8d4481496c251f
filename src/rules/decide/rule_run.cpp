// SPDX-License-Identifier: Apache-2.0
// Decides about the seeds of a rule by decreasing size, and retries rejected ones after others were accepted.
#include "rules/decide/rule_run.hpp"

#include <algorithm>

#include "rules/decide/decision_record.hpp"
#include "rules/decide/rule_reach.hpp"
#include "rules/objects/object_making.hpp"
#include "rules/objects/seed_groups.hpp"

namespace cluxel::rules {

namespace {

class RuleRun {
 public:
  RuleRun(ReasoningState& state, const Rule& rule)
      : state_(state), rule_(rule), reach_(reachOf(rule, state.grid)), changes_(reach_.value_or(0)) {}

  void run() {
    state_.trace.enter(mixed(StepKind::Judged, hashOf(rule_.id)));
    SliceScope scope(state_, rule_);
    std::vector<Open> open;
    for (std::vector<FragmentIndex>& group : seedGroups(state_, rule_, scope.slices()))
      open.push_back({std::move(group)});
    // A new or a larger object may be near a seed that was rejected before, and what is left unknown cannot be found
    // any more: retry rejected seeds until nothing changes. What happens far away must not decide whether a seed is
    // retried.
    std::uint64_t pass = 0;
    for (bool changed = true; changed && !open.empty();) {
      state_.trace.enterRound(++pass);
      changed = false;
      std::vector<Open> rejected;
      for (Open& seed : open) {
        std::erase_if(seed.group, [this](FragmentIndex fragment) { return !isFree(fragment); });
        if (seed.group.empty()) continue;
        if (!isSettled(seed) && !decide(seed, changed)) continue;
        rejected.push_back(std::move(seed));
      }
      open = std::move(rejected);
    }
    for (Open& seed : open) state_.decisions.push_back(std::move(*seed.rejection));
    state_.trace.enterRound(0);  // how many passes there were may be due to what happened far away
    scope.putBack();
  }

 private:
  /// A group of seeds that may be judged again, with its last rejection.
  struct Open {
    std::vector<FragmentIndex> group;
    std::optional<Decision> rejection = std::nullopt;
    std::uint32_t changes = 0;  ///< of the state, when it was rejected
    std::size_t judged = 0;     ///< fragments of the group when it was rejected
  };

  bool isFree(FragmentIndex fragment) const {
    return state_.fragments[fragment].alive && state_.fragments[fragment].owner == kFree;
  }

  Eigen::AlignedBox2d boxOf(const std::vector<FragmentIndex>& group) const {
    Eigen::AlignedBox2d box;
    for (FragmentIndex fragment : group) {
      // Relations lead from whole primitives to whole primitives.
      const perception::Primitive& primitive = state_.scene.primitives[state_.fragments[fragment].primitive];
      box.extend(Eigen::Vector2d(primitive.min.head<2>()));
      box.extend(Eigen::Vector2d(primitive.max.head<2>()));
    }
    return box;
  }

  /// Whether judging again would give the same rejection.
  bool isSettled(const Open& seed) const {
    return reach_ && seed.rejection && seed.judged == seed.group.size() &&
           !changes_.anyNear(boxOf(seed.group), seed.changes);
  }

  /// Decides about one group. Records an acceptance or a final rejection and returns false; returns true for a
  /// rejection that may be retried. Sets `changed` when some fragment got another owner.
  bool decide(Open& seed, bool& changed) {
    Verdict verdict = judge(state_, rule_, seed.group);
    noteJudged(seed, verdict);
    if (verdict.accept != nullptr && state_.context.onCandidate) state_.context.onCandidate(state_, rule_, verdict);
    if (verdict.accept != nullptr && verdict.decision.log_odds <= kMinLogOdds) {
      verdict.decision.accepted = false;
      if (state_.context.keeps_paths) verdict.decision.reason = kAgainstEvidence;
      verdict.accept = nullptr;
      verdict.leaves_unknown = false;
    }
    if (verdict.accept != nullptr) {
      accept(std::move(verdict), seed.group);
      changed = true;
      return false;
    }
    if (!verdict.leaves_unknown) {
      seed.rejection = std::move(verdict.decision);
      seed.changes = changes_.count();
      seed.judged = seed.group.size();
      return true;
    }
    changed = true;
    for (FragmentIndex fragment : seed.group) state_.setOwner(fragment, kUnknown);
    state_.decisions.push_back(std::move(verdict.decision));
    return false;
  }

  std::optional<OwnerIndex> objectToJoin(const Verdict& verdict) const {
    if (verdict.accept->merge_into == MergeInto::Related) return verdict.related;
    if (verdict.accept->merge_into == MergeInto::Nothing) return std::nullopt;
    const auto first = std::find_if(state_.objects.begin(), state_.objects.end(), [&](const ObjectInMaking& object) {
      return object.rule->class_iri == rule_.class_iri;
    });
    if (first == state_.objects.end()) return std::nullopt;
    return static_cast<OwnerIndex>(first - state_.objects.begin());
  }

  void noteJudged(const Open& seed, const Verdict& verdict) {
    state_.trace.keep(state_.trace.setOf(verdict.members));
    if (state_.trace.isNews(state_.fragments.hashOf(seed.group), verdict.trace))
      state_.trace.noteStep(verdict.members, verdict.trace);
  }

  void accept(Verdict verdict, const std::vector<FragmentIndex>& group) {
    state_.decisions.push_back(std::move(verdict.decision));
    changes_.add(boxOf(group));
    if (const std::optional<OwnerIndex> object = objectToJoin(verdict)) {
      joinRelated(state_, rule_, *object, verdict, group);
    } else {
      makeObject(state_, rule_, std::move(verdict));
    }
  }

  ReasoningState& state_;
  const Rule& rule_;
  std::optional<double> reach_;
  NearbyChanges changes_;
};

}  // namespace

void runRule(ReasoningState& state, const Rule& rule) {
  RuleRun(state, rule).run();
}

}  // namespace cluxel::rules
