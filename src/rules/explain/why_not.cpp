// SPDX-License-Identifier: Apache-2.0
// Ranks what the rules of a class say: the rule that made the thing, what accepts it, then by the least change of
// values, then what cannot be changed.
#include "rules/explain/why_not.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "rules/explain/counterfactuals.hpp"

namespace cluxel::rules {

namespace {

class WhyNotSearch {
 public:
  WhyNotSearch(const RuleSet& rules, const ReasoningResult& made, const SemanticObject* owner)
      : rules_(rules), made_(made), owner_(owner) {}

  RuleVerdict verdictOf(Consideration said) const {
    const Rule& rule = *rules_.find(said.decision.rule_id);
    RuleVerdict verdict;
    verdict.class_iri = rule.class_iri;
    if (!said.has_label)
      verdict.nearness = Nearness::OtherLabel;
    else if (!said.is_seed)
      seedTests(rule, said.decision, verdict);
    else if (said.decision.accepted)
      lostTo(said.decision, verdict);
    else
      leastChange(said.decision, verdict);
    verdict.decision = std::move(said.decision);
    return verdict;
  }

 private:
  static void seedTests(const Rule& rule, const Decision& decision, RuleVerdict& verdict) {
    verdict.nearness = Nearness::NoSeed;
    Condition all;
    all.kind = Condition::Kind::All;
    all.operands = rule.seed.where;
    if (all.operands.empty()) return;
    const bool failed =
        std::any_of(decision.path.begin(), decision.path.end(), [](const auto& s) { return !s.passed; });
    auto changes = failed ? counterfactualChanges(all, decision.path, 0) : std::nullopt;
    if (changes) verdict.counterfactual = Counterfactual{std::move(*changes), false, "it is a seed of the rule"};
  }

  static void leastChange(const Decision& decision, RuleVerdict& verdict) {
    verdict.nearness = Nearness::Rejected;
    for (const DecisionFlip& flip : decision.flips) {
      if (!flip.accepted) continue;
      if (verdict.counterfactual && costOf(flip.changes) >= costOf(verdict.counterfactual->changes)) continue;
      verdict.counterfactual = Counterfactual{flip.changes, true, flip.outcome};
      verdict.nearness = Nearness::Changeable;
    }
  }

  void lostTo(const Decision& decision, RuleVerdict& verdict) const {
    verdict.nearness = Nearness::Accepted;
    if (owner_ == nullptr) return;
    const Decision& won = made_.decisions.at(owner_->decision);
    verdict.winner = RivalNote{owner_->rule_id, owner_->class_iri, won.log_odds, true};
    verdict.behind = won.log_odds - decision.log_odds;
  }

  const RuleSet& rules_;
  const ReasoningResult& made_;
  const SemanticObject* owner_;
};

double costOfVerdict(const RuleVerdict& verdict) {
  if (verdict.madeThing()) return -std::numeric_limits<double>::infinity();
  if (verdict.nearness == Nearness::Accepted) return verdict.behind;
  if (verdict.counterfactual) return costOf(verdict.counterfactual->changes);
  // What cannot be changed: the farther down the tree, the nearer.
  return 1e6 - static_cast<double>(verdict.decision.path.size());
}

}  // namespace

std::string_view nameOf(Nearness nearness) {
  static constexpr std::array<std::string_view, 5> kNames{"accepted", "changeable", "rejected", "no seed",
                                                          "other label"};
  return kNames[static_cast<std::size_t>(nearness)];
}

WhyNot whyNot(std::vector<Consideration> said, const RuleSet& rules, const ReasoningResult& made,
              const SemanticObject* owner, const std::string& class_iri) {
  WhyNot why;
  why.class_iri = class_iri;
  const WhyNotSearch search(rules, made, owner);
  for (Consideration& one : said) why.rules.push_back(search.verdictOf(std::move(one)));
  std::stable_sort(why.rules.begin(), why.rules.end(), [](const RuleVerdict& a, const RuleVerdict& b) {
    return std::pair(a.nearness, costOfVerdict(a)) < std::pair(b.nearness, costOfVerdict(b));
  });
  // A rule may have judged several primitives: only its nearest verdict is kept.
  std::vector<RuleVerdict> best;
  for (RuleVerdict& verdict : why.rules)
    if (std::none_of(best.begin(), best.end(),
                     [&](const RuleVerdict& known) { return known.decision.rule_id == verdict.decision.rule_id; }))
      best.push_back(std::move(verdict));
  why.rules = std::move(best);
  return why;
}

}  // namespace cluxel::rules
