// SPDX-License-Identifier: Apache-2.0
// Rounds of proposals. A group of seeds that a rule rejected is not proposed to it again; a candidate that lost is, as
// long as its seeds are free.
#include "rules/decide/competition.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "rules/decide/decision_record.hpp"
#include "rules/decide/rivals.hpp"
#include "rules/objects/object_making.hpp"
#include "rules/objects/seed_groups.hpp"

namespace cluxel::rules {

namespace {

/// A chance of one in three: what is likelier than that is decided first.
constexpr double kLikely = -0.693147;

struct Proposal {
  const Rule* rule = nullptr;
  Verdict verdict;
  std::vector<FragmentIndex> group;
};

class Competition {
 public:
  Competition(ReasoningState& state, std::span<const Rule* const> rules) : state_(state), rules_(rules) {}

  void run() {
    while (true) {
      std::vector<Proposal> proposals = propose();
      const std::vector<Rival> rivals = rivalsOf(proposals);
      const std::vector<bool> wins = chooseAmongRivals(rivals);
      recordLosers(proposals, rivals, wins);
      for (std::size_t i = 0; i < proposals.size(); ++i)
        if (wins[i]) accept(proposals[i]);
      if (!anyOf(wins)) break;
    }
    for (const std::vector<FragmentIndex>& group : unknown_)
      for (FragmentIndex fragment : group)
        if (state_.fragments[fragment].owner == kFree) state_.fragments.setOwner(fragment, kUnknown);
  }

 private:
  static bool anyOf(const std::vector<bool>& wins) { return std::find(wins.begin(), wins.end(), true) != wins.end(); }

  std::vector<Proposal> propose() {
    std::vector<Proposal> proposals;
    for (const Rule* rule : rules_) {
      std::vector<std::vector<FragmentIndex>> groups = seedGroups(state_, *rule, {});
      std::erase_if(groups, [&](const auto& group) { return rejected_.count({rule, group}) > 0; });
      std::vector<Verdict> verdicts(groups.size());
      parallelFor(groups.size(), state_.threads(),
                  [&](std::size_t i) { verdicts[i] = judge(state_, *rule, groups[i]); });
      for (std::size_t i = 0; i < groups.size(); ++i) {
        Verdict& verdict = verdicts[i];
        std::vector<FragmentIndex>& group = groups[i];
        if (verdict.accept != nullptr) {
          if (state_.context.onCandidate && !state_.is_first_of_two_rounds && lost_.count({rule, group}) == 0)
            state_.context.onCandidate(state_, *rule, verdict);
          proposals.push_back({rule, std::move(verdict), std::move(group)});
          continue;
        }
        state_.decisions.push_back(std::move(verdict.decision));
        if (verdict.leaves_unknown) unknown_.push_back(group);
        rejected_.emplace(rule, std::move(group));
      }
    }
    return proposals;
  }

  std::vector<Rival> rivalsOf(const std::vector<Proposal>& proposals) const {
    std::vector<Rival> rivals;
    std::vector<char> is_likely;
    for (const Proposal& proposal : proposals) {
      const AcceptLeaf& accept = *proposal.verdict.accept;
      const Bindings& bindings = proposal.verdict.bindings;
      Rival rival;
      const LogOddsOfNothing nothing = logOddsOfNothing(state_, accept, bindings);
      const double log_odds = proposal.verdict.decision.log_odds;
      rival.score = log_odds > nothing.as_one ? std::llround((log_odds - nothing.sum) * 1e6) : 0;
      is_likely.push_back(rival.score > 0 && log_odds >= kLikely ? 1 : 0);
      rival.share_class = static_cast<std::uint32_t>(
          std::find(state_.rules.order.begin(), state_.rules.order.end(), proposal.rule->class_iri) -
          state_.rules.order.begin());
      for (const auto& [name, part_class] : accept.parts) {
        const bool shared = accept.splitting && accept.splitting->part == name;
        for (FragmentIndex fragment : bindings.at(name).fragments) {
          const OwnerIndex owner = state_.fragments[fragment].owner;
          if (shared && (owner == kFree || owner == kShared))
            rival.shared.push_back(fragment);
          else if (owner == kFree)
            rival.owned.push_back(fragment);
        }
      }
      rivals.push_back(std::move(rival));
    }
    holdBackUnlikely(rivals, is_likely);
    return rivals;
  }

  /// When a group of rivals has a likely member, the unlikely ones cannot win in this round.
  static void holdBackUnlikely(std::vector<Rival>& rivals, const std::vector<char>& is_likely) {
    const auto conflicts = conflictsOf(rivals);
    DisjointSets groups(rivals.size());
    for (std::uint32_t i = 0; i < rivals.size(); ++i)
      for (const std::uint32_t other : conflicts[i]) groups.join(i, other);
    std::vector<char> has_likely(rivals.size(), 0);
    for (std::uint32_t i = 0; i < rivals.size(); ++i)
      if (is_likely[i] != 0) has_likely[groups.find(i)] = 1;
    for (std::uint32_t i = 0; i < rivals.size(); ++i)
      if (is_likely[i] == 0 && has_likely[groups.find(i)] != 0) {
        rivals[i].is_held_back = rivals[i].score > 0;
        rivals[i].score = 0;
      }
  }

  /// Records which rival a losing candidate lost to; only its first defeat. One that was held back, and that no winner
  /// touches, has lost to nobody: it is decided in a later round.
  void recordLosers(std::vector<Proposal>& proposals, const std::vector<Rival>& rivals, const std::vector<bool>& wins) {
    const auto conflicts = conflictsOf(rivals);
    for (std::size_t i = 0; i < proposals.size(); ++i) {
      Decision& decision = proposals[i].verdict.decision;
      for (std::uint32_t other : conflicts[i])
        decision.rivals.push_back({proposals[other].rule->id, proposals[other].rule->class_iri,
                                   proposals[other].verdict.decision.log_odds, bool{wins[other]}});
      if (rivals[i].is_held_back && !lostTo(decision)) continue;
      if (wins[i] || !lost_.emplace(proposals[i].rule, proposals[i].group).second) continue;
      Decision record = decision;
      record.accepted = false;
      record.reason = reasonOfDefeat(decision);
      state_.decisions.push_back(std::move(record));
    }
  }

  /// The rival that won; null when none did.
  static const RivalNote* lostTo(const Decision& decision) {
    const auto winner =
        std::find_if(decision.rivals.begin(), decision.rivals.end(), [](const RivalNote& note) { return note.won; });
    return winner == decision.rivals.end() ? nullptr : &*winner;
  }

  std::string reasonOfDefeat(const Decision& decision) const {
    const RivalNote* winner = lostTo(decision);
    if (winner == nullptr) return "the evidence speaks against it";
    return "the evidence for " + state_.rules.shorten(winner->class_iri) + " is stronger";
  }

  void accept(Proposal& proposal) {
    state_.decisions.push_back(std::move(proposal.verdict.decision));
    makeObject(state_, *proposal.rule, *proposal.verdict.accept, std::move(proposal.verdict.bindings));
  }

  ReasoningState& state_;
  std::span<const Rule* const> rules_;
  std::set<std::pair<const Rule*, std::vector<FragmentIndex>>> rejected_, lost_;
  std::vector<std::vector<FragmentIndex>> unknown_;  ///< seeds of leaves with `leave: unknown`
};

}  // namespace

void compete(ReasoningState& state, std::span<const Rule* const> rules) {
  Competition(state, rules).run();
}

}  // namespace cluxel::rules
