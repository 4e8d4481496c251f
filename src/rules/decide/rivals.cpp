// SPDX-License-Identifier: Apache-2.0
// Branch and bound on small groups of rivals, exchanges on large ones.
#include "rules/decide/rivals.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "base/disjoint_sets.hpp"

namespace cluxel::rules {

namespace {

/// Who wants an item, and how.
struct Want {
  std::uint32_t rival = 0;
  bool is_shared = false;
};

/// Finds the best independent set among at most 64 rivals by depth-first search. The first set found with a score wins,
/// and earlier rivals are tried first.
class ExactChoice {
 public:
  ExactChoice(const std::vector<std::int64_t>& scores, const std::vector<std::uint64_t>& conflicts)
      : scores_(scores), conflicts_(conflicts), rest_(scores.size() + 1, 0) {
    for (std::size_t i = scores.size(); i > 0; --i) rest_[i - 1] = rest_[i] + scores[i - 1];
  }

  std::uint64_t best() {
    visit(0, 0, 0, 0);
    return best_set_;
  }

 private:
  void visit(std::size_t at, std::uint64_t chosen, std::uint64_t blocked, std::int64_t score) {
    if (score > best_score_) {
      best_score_ = score;
      best_set_ = chosen;
    }
    if (at == scores_.size() || score + rest_[at] <= best_score_) return;
    const std::uint64_t bit = std::uint64_t{1} << at;
    if ((blocked & bit) == 0) visit(at + 1, chosen | bit, blocked | conflicts_[at], score + scores_[at]);
    visit(at + 1, chosen, blocked, score);
  }

  const std::vector<std::int64_t>& scores_;
  const std::vector<std::uint64_t>& conflicts_;
  std::vector<std::int64_t> rest_;  ///< sum of the scores from here on
  std::int64_t best_score_ = 0;
  std::uint64_t best_set_ = 0;
};

class RivalChoice {
 public:
  explicit RivalChoice(std::span<const Rival> rivals)
      : rivals_(rivals), conflicts_(conflictsOf(rivals)), chosen_(rivals.size(), false) {}

  std::vector<bool> run() {
    for (std::vector<std::uint32_t>& group : groups())
      if (group.size() <= kMaxExactRivals)
        choose(exact(group));
      else
        chooseBySearch(group);
    return std::move(chosen_);
  }

 private:
  /// Connected rivals with a score above 0, each group ascending.
  std::vector<std::vector<std::uint32_t>> groups() const {
    DisjointSets sets(rivals_.size());
    for (std::uint32_t i = 0; i < rivals_.size(); ++i)
      for (std::uint32_t other : conflicts_[i])
        if (rivals_[i].score > 0 && rivals_[other].score > 0) sets.join(i, other);
    std::map<std::size_t, std::vector<std::uint32_t>> by_root;
    for (std::uint32_t i = 0; i < rivals_.size(); ++i)
      if (rivals_[i].score > 0) by_root[sets.find(i)].push_back(i);
    std::vector<std::vector<std::uint32_t>> groups;
    for (auto& [root, members] : by_root) groups.push_back(std::move(members));
    return groups;
  }

  void choose(const std::vector<std::uint32_t>& members) {
    for (std::uint32_t rival : members) chosen_[rival] = true;
  }

  std::vector<std::uint32_t> exact(const std::vector<std::uint32_t>& group) const {
    std::vector<std::int64_t> scores;
    std::vector<std::uint64_t> conflicts;
    for (std::uint32_t rival : group) {
      scores.push_back(rivals_[rival].score);
      std::uint64_t bits = 0;
      for (std::size_t k = 0; k < group.size(); ++k)
        if (std::binary_search(conflicts_[rival].begin(), conflicts_[rival].end(), group[k]))
          bits |= std::uint64_t{1} << k;
      conflicts.push_back(bits);
    }
    const std::uint64_t best = ExactChoice(scores, conflicts).best();
    std::vector<std::uint32_t> members;
    for (std::size_t k = 0; k < group.size(); ++k)
      if ((best >> k & 1U) != 0) members.push_back(group[k]);
    return members;
  }

  /// Starts with the highest scores. Then exchanges a chosen rival for others that it alone blocks, or chosen rivals
  /// for one that they block, while the sum grows.
  void chooseBySearch(const std::vector<std::uint32_t>& group) {
    std::vector<std::uint32_t> by_score = group;
    std::stable_sort(by_score.begin(), by_score.end(),
                     [this](std::uint32_t a, std::uint32_t b) { return rivals_[a].score > rivals_[b].score; });
    for (std::uint32_t rival : by_score)
      if (blockersOf(rival).empty()) chosen_[rival] = true;
    for (bool improved = true; improved;) {
      improved = false;
      for (std::uint32_t rival : group) improved = (chosen_[rival] ? giveWay(rival) : pushIn(rival)) || improved;
    }
  }

  std::vector<std::uint32_t> blockersOf(std::uint32_t rival) const {
    std::vector<std::uint32_t> blockers;
    for (std::uint32_t other : conflicts_[rival])
      if (chosen_[other]) blockers.push_back(other);
    return blockers;
  }

  /// Takes a rival in when it is worth more than all that block it.
  bool pushIn(std::uint32_t rival) {
    const auto blockers = blockersOf(rival);
    if (rivals_[rival].score <= sum(blockers)) return false;
    for (std::uint32_t blocker : blockers) chosen_[blocker] = false;
    chosen_[rival] = true;
    return true;
  }

  /// Replaces a chosen rival by the best of those that it alone blocks.
  bool giveWay(std::uint32_t rival) {
    std::vector<std::uint32_t> waiting;
    for (std::uint32_t other : conflicts_[rival])
      if (rivals_[other].score > 0 && blockersOf(other).size() == 1 && waiting.size() < kMaxExactRivals)
        waiting.push_back(other);
    const auto better = exact(waiting);
    if (sum(better) <= rivals_[rival].score) return false;
    chosen_[rival] = false;
    choose(better);
    return true;
  }

  std::int64_t sum(const std::vector<std::uint32_t>& members) const {
    std::int64_t total = 0;
    for (std::uint32_t member : members) total += rivals_[member].score;
    return total;
  }

  std::span<const Rival> rivals_;
  std::vector<std::vector<std::uint32_t>> conflicts_;
  std::vector<bool> chosen_;
};

}  // namespace

std::vector<std::vector<std::uint32_t>> conflictsOf(std::span<const Rival> rivals) {
  std::map<std::uint32_t, std::vector<Want>> wants;
  for (std::uint32_t i = 0; i < rivals.size(); ++i) {
    for (std::uint32_t item : rivals[i].owned) wants[item].push_back({i, false});
    for (std::uint32_t item : rivals[i].shared) wants[item].push_back({i, true});
  }
  std::vector<std::vector<std::uint32_t>> conflicts(rivals.size());
  for (const auto& [item, all] : wants)
    for (const Want& a : all)
      for (const Want& b : all) {
        if (a.rival == b.rival) continue;
        const bool same = rivals[a.rival].share_class == rivals[b.rival].share_class;
        if (!(a.is_shared && b.is_shared && same)) conflicts[a.rival].push_back(b.rival);
      }
  for (auto& others : conflicts) {
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
  }
  return conflicts;
}

std::vector<bool> chooseAmongRivals(std::span<const Rival> rivals) {
  return RivalChoice(rivals).run();
}

}  // namespace cluxel::rules
