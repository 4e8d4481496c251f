// SPDX-License-Identifier: Apache-2.0
// Rounds of proposals. A group of seeds that a rule rejected is not proposed to it again; a candidate that lost is, as
// long as its seeds are free.
#include "rules/decide/competition.hpp"

#include <algorithm>
#include <map>
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
    state_.trace.enter(mixed(StepKind::Rivals, std::uint64_t{state_.is_first_of_two_rounds}));
    for (std::uint64_t round = 1;; ++round) {
      state_.trace.enterRound(round);
      std::vector<Proposal> proposals = propose();
      std::vector<Rival> rivals = rivalsOf(proposals);
      const Conflicts conflicts = conflictsOf(rivals);
      const std::vector<std::uint32_t> group = groupsOf(conflicts);
      holdBackUnlikely(rivals, group);
      const std::vector<bool> wins = chooseAmongRivals(rivals);
      noteRivals(proposals, rivals, group, wins);
      recordLosers(proposals, rivals, conflicts, wins);
      for (std::size_t i = 0; i < proposals.size(); ++i)
        if (wins[i]) accept(proposals[i]);
      if (!anyOf(wins)) break;
    }
    state_.trace.enterRound(0);  // how many rounds there were may be due to what happened far away
    for (const std::vector<FragmentIndex>& group : unknown_)
      for (FragmentIndex fragment : group)
        if (state_.fragments[fragment].owner == kFree) state_.setOwner(fragment, kUnknown);
  }

 private:
  using Conflicts = std::vector<std::vector<std::uint32_t>>;

  static bool anyOf(const std::vector<bool>& wins) { return std::find(wins.begin(), wins.end(), true) != wins.end(); }

  std::vector<Proposal> propose() {
    std::vector<Proposal> proposals;
    for (const Rule* rule : rules_) {
      std::vector<std::vector<FragmentIndex>> groups = seedGroups(state_, *rule, {}, &links_[rule]);
      std::erase_if(groups, [&](const auto& group) { return rejected_.count({rule, group}) > 0; });
      std::vector<Verdict> verdicts(groups.size());
      parallelFor(groups.size(), state_.threads(),
                  [&](std::size_t i) { verdicts[i] = judge(state_, *rule, groups[i]); });
      for (std::size_t i = 0; i < groups.size(); ++i) {
        Verdict& verdict = verdicts[i];
        std::vector<FragmentIndex>& group = groups[i];
        noteJudged(*rule, group, verdict);
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

  /// A candidate that loses is judged again in each round: noted is what is new.
  void noteJudged(const Rule& rule, const std::vector<FragmentIndex>& group, const Verdict& verdict) {
    state_.trace.keep(state_.trace.setOf(verdict.members));
    if (state_.trace.isNews(mixed(hashOf(rule.id), state_.fragments.hashOf(group)), verdict.trace))
      state_.trace.noteStep(verdict.members, verdict.trace);
  }

  std::vector<Rival> rivalsOf(const std::vector<Proposal>& proposals) const {
    std::vector<Rival> rivals;
    for (const Proposal& proposal : proposals) {
      const AcceptLeaf& accept = *proposal.verdict.accept;
      const Bindings& bindings = proposal.verdict.bindings;
      Rival rival;
      const double log_odds = proposal.verdict.decision.log_odds;
      rival.score = logOddsOfNothing(state_, accept, bindings).scoreOf(log_odds);
      rival.is_likely = rival.score > 0 && log_odds >= kLikely;
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
    return rivals;
  }

  /// For each rival the number of its group: rivals that conflict, directly or through others.
  static std::vector<std::uint32_t> groupsOf(const Conflicts& conflicts) {
    DisjointSets groups(conflicts.size());
    for (std::uint32_t i = 0; i < conflicts.size(); ++i)
      for (const std::uint32_t other : conflicts[i]) groups.join(i, other);
    return groups.numbers();
  }

  /// When a group of rivals has a likely member, the unlikely ones cannot win in this round.
  static void holdBackUnlikely(std::vector<Rival>& rivals, const std::vector<std::uint32_t>& group) {
    std::vector<char> has_likely(rivals.size(), 0);
    for (std::size_t i = 0; i < rivals.size(); ++i)
      if (rivals[i].is_likely) has_likely[group[i]] = 1;
    for (std::size_t i = 0; i < rivals.size(); ++i)
      if (!rivals[i].is_likely && has_likely[group[i]] != 0) {
        rivals[i].is_held_back = rivals[i].score > 0;
        rivals[i].score = 0;
      }
  }

  /// The settling of a group is one step of all primitives that its members bound.
  void noteRivals(const std::vector<Proposal>& proposals, const std::vector<Rival>& rivals,
                  const std::vector<std::uint32_t>& group, const std::vector<bool>& wins) {
    struct Settled {
      std::uint64_t trace = 0;
      std::vector<perception::PrimitiveIndex> members;
    };
    std::vector<Settled> settled(proposals.size());
    for (std::size_t i = 0; i < proposals.size(); ++i) {
      Settled& of_group = settled[group[i]];
      const auto score = static_cast<std::uint64_t>(rivals[i].score);
      of_group.trace += mixed(mixed(proposals[i].verdict.trace, score), std::uint64_t{wins[i]});
      const auto& members = proposals[i].verdict.members;
      of_group.members.insert(of_group.members.end(), members.begin(), members.end());
    }
    for (Settled& of_group : settled) {
      state_.trace.keep(state_.trace.setOf(of_group.members));
      const std::uint64_t trace = mixed(StepKind::Rivals, of_group.trace);
      if (of_group.members.empty() || !state_.trace.isNews(trace, trace)) continue;
      std::sort(of_group.members.begin(), of_group.members.end());
      of_group.members.erase(std::unique(of_group.members.begin(), of_group.members.end()), of_group.members.end());
      state_.trace.noteStep(of_group.members, trace);
    }
  }

  /// Records which rival a losing candidate lost to; only its first defeat. One that was held back, and that no winner
  /// touches, has lost to nobody: it is decided in a later round.
  void recordLosers(std::vector<Proposal>& proposals, const std::vector<Rival>& rivals, const Conflicts& conflicts,
                    const std::vector<bool>& wins) {
    for (std::size_t i = 0; i < proposals.size(); ++i) {
      Decision& decision = proposals[i].verdict.decision;
      for (std::uint32_t other : conflicts[i])
        decision.rivals.push_back({proposals[other].rule->id, proposals[other].rule->class_iri,
                                   proposals[other].verdict.decision.log_odds, bool{wins[other]}});
      if (rivals[i].is_held_back && !lostTo(decision)) continue;
      if (wins[i] || !lost_.emplace(proposals[i].rule, proposals[i].group).second) continue;
      Decision record = decision;
      record.accepted = false;
      if (state_.context.keeps_paths) record.reason = reasonOfDefeat(decision);
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
    if (winner == nullptr) return kAgainstEvidence;
    return "the evidence for " + state_.rules.shorten(winner->class_iri) + " is stronger";
  }

  void accept(Proposal& proposal) {
    state_.decisions.push_back(std::move(proposal.verdict.decision));
    makeObject(state_, *proposal.rule, std::move(proposal.verdict));
  }

  ReasoningState& state_;
  std::span<const Rule* const> rules_;
  std::set<std::pair<const Rule*, std::vector<FragmentIndex>>> rejected_, lost_;
  std::map<const Rule*, KnownLinks> links_;          ///< of the first round; no round cuts fragments
  std::vector<std::vector<FragmentIndex>> unknown_;  ///< seeds of leaves with `leave: unknown`
};

}  // namespace

void compete(ReasoningState& state, std::span<const Rule* const> rules) {
  Competition(state, rules).run();
}

}  // namespace cluxel::rules
