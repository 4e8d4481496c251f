// SPDX-License-Identifier: Apache-2.0
// Decides about the seeds of a rule by decreasing size, and retries rejected ones while objects grow.
#include "rules/decide/rule_run.hpp"

#include "rules/decide/decision_record.hpp"
#include "rules/objects/object_making.hpp"
#include "rules/objects/seed_groups.hpp"

namespace cluxel::rules {

namespace {

/// A candidate without rivals is rejected when the evidence leaves it a chance below one in twenty.
constexpr double kMinLogOdds = -3;

class RuleRun {
 public:
  RuleRun(ReasoningState& state, const Rule& rule) : state_(state), rule_(rule) {}

  void run() {
    SliceScope scope(state_, rule_);
    auto open = seedGroups(state_, rule_, scope.slices());
    // An object that grows may come near a seed that was rejected before: retry rejected seeds until no object grows.
    for (bool grown = true; grown && !open.empty();) {
      grown = false;
      std::vector<std::vector<FragmentIndex>> rejected;
      std::vector<Decision> rejections;
      for (auto& group : open) {
        std::erase_if(group, [this](FragmentIndex fragment) { return !isFree(fragment); });
        if (group.empty()) continue;
        auto rejection = decide(group, grown);
        if (!rejection) continue;
        rejections.push_back(std::move(*rejection));
        rejected.push_back(std::move(group));
      }
      if (!grown) std::move(rejections.begin(), rejections.end(), std::back_inserter(state_.decisions));
      open = grown ? std::move(rejected) : std::vector<std::vector<FragmentIndex>>{};
    }
    scope.putBack();
  }

 private:
  bool isFree(FragmentIndex fragment) const {
    return state_.fragments[fragment].alive && state_.fragments[fragment].owner == kFree;
  }

  /// Decides about one group. Records an acceptance or a final rejection and returns nothing; returns a rejection that
  /// may be retried. Sets `grown` when the group joined an existing object.
  std::optional<Decision> decide(const std::vector<FragmentIndex>& group, bool& grown) {
    Verdict verdict = judge(state_, rule_, group);
    if (verdict.accept != nullptr && state_.context.onCandidate) state_.context.onCandidate(state_, rule_, verdict);
    if (verdict.accept != nullptr && verdict.decision.log_odds <= kMinLogOdds) {
      verdict.decision.accepted = false;
      verdict.decision.reason = "the evidence speaks against it";
      return std::move(verdict.decision);
    }
    if (verdict.accept == nullptr) {
      if (!verdict.leaves_unknown) return std::move(verdict.decision);
      for (FragmentIndex fragment : group) state_.fragments.setOwner(fragment, kUnknown);
      state_.decisions.push_back(std::move(verdict.decision));
      return std::nullopt;
    }
    state_.decisions.push_back(std::move(verdict.decision));
    if (verdict.accept->merge_into_related && verdict.related) {
      joinRelated(state_, rule_, *verdict.related, verdict.accept->parts.front(), group);
      grown = true;
    } else {
      makeObject(state_, rule_, *verdict.accept, std::move(verdict.bindings));
    }
    return std::nullopt;
  }

  ReasoningState& state_;
  const Rule& rule_;
};

}  // namespace

void runRule(ReasoningState& state, const Rule& rule) {
  RuleRun(state, rule).run();
}

}  // namespace cluxel::rules
