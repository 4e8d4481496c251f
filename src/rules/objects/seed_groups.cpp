// SPDX-License-Identifier: Apache-2.0
// Groups are joined along links, shortest first, as long as the limits hold: the result is independent of fragment
// order.
#include "rules/objects/seed_groups.hpp"

#include <algorithm>
#include <array>

#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "rules/decide/threshold_margins.hpp"
#include "rules/propose/condition_eval.hpp"

namespace cluxel::rules {

namespace {

bool isIn(const std::vector<scan::PrimitiveLabel>& labels, scan::PrimitiveLabel label) {
  return std::find(labels.begin(), labels.end(), label) != labels.end();
}

bool passes(const ReasoningState& state, const Rule& rule, const std::vector<Condition>& conditions,
            Candidate candidate) {
  if (conditions.empty()) return true;
  Bindings bindings;
  bindings.candidates.emplace_back(rule.seed.name, std::move(candidate));
  return ConditionEvaluator(state, rule, bindings).allHold(conditions);
}

/// Joins members along links (union-find), skipping joins that would violate a limit.
class Joining {
 public:
  Joining(ReasoningState& state, const Rule& rule, const std::vector<FragmentIndex>& members)
      : state_(state),
        rule_(rule),
        members_(members),
        sets_(members.size()),
        held_(members.size()),
        by_outline_(std::all_of(limits().begin(), limits().end(), [](const Condition& limit) {
          return limit.kind == Condition::Kind::Attribute && !limit.slice && limit.ratio_of.empty() &&
                 isOfOutline(limit.attribute);
        })) {
    for (std::size_t i = 0; i < members.size(); ++i) {
      held_[i].fragments = {members[i]};
      held_[i].trace = state.fragments.hashOf(members[i]);
      held_[i].members = state.membersOf(held_[i].fragments);
    }
    if (limits().empty() || !by_outline_) return;
    for (std::size_t i = 0; i < members.size(); ++i) held_[i].outline = state.fragments.outlineOf(members[i]);
  }

  std::vector<std::vector<FragmentIndex>> groups(const SeedLinks& links) {
    std::vector<Pair> idle;  // links between what was one already
    for (const SeedLink& link : links.links)
      if (!join(setOf(link.a), setOf(link.b)) && !links.notes.empty()) idle.emplace_back(link.a, link.b);
    std::sort(idle.begin(), idle.end());
    for (const LinkNote& note : links.notes) noteLink(note, idle);
    std::vector<std::vector<FragmentIndex>> groups;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (setOf(i) != i) continue;
      if (held_[i].is_linked) note(held_[i]);
      groups.push_back(std::move(held_[i].fragments));
    }
    return groups;
  }

 private:
  struct Group {
    std::vector<FragmentIndex> fragments;
    Outline outline;          ///< maintained only when all limits can be tested on it
    std::uint64_t trace = 0;  ///< a hash of all joins and refusals that led to it
    MemberSet members = kNobody;
    bool is_linked = false;
  };

  using Pair = std::pair<std::size_t, std::size_t>;

  /// A link that is idle, and one between members of one group that would come after all others, does not matter.
  void noteLink(const LinkNote& note, const std::vector<Pair>& idle) {
    const bool is_link = note.distance_m <= state_.rules.thresholds[note.threshold - 1].value;
    if (is_link ? std::binary_search(idle.begin(), idle.end(), Pair(note.a, note.b)) : setOf(note.a) == setOf(note.b))
      return;
    state_.context.margins->note(state_.fragments[members_[note.a]].primitive, note.threshold, note.distance_m);
  }

  /// While a group of earlier rounds has all that its trace tells of, it comes about again: no trace returns.
  void note(const Group& group) {
    const std::uint64_t trace = mixed(StepKind::Grouped, mixed(hashOf(rule_.id), group.trace));
    if (!state_.trace.isNews(trace, trace)) return;
    for (const FragmentIndex fragment : group.fragments) state_.trace.note(state_.fragments[fragment].primitive, trace);
  }

  /// Notes that the limits forbid to join the two.
  void noteRefusal(Group& a, Group& b) {
    const std::uint64_t of_a = a.trace;
    a.trace = mixed(StepKind::Refused, mixed(a.trace, b.trace));
    b.trace = mixed(StepKind::Refused, mixed(b.trace, of_a));
  }

  const std::vector<Condition>& limits() const { return rule_.group->limits; }
  std::uint32_t setOf(std::size_t i) { return sets_.find(static_cast<std::uint32_t>(i)); }

  /// False when the two are one.
  bool join(std::uint32_t a, std::uint32_t b) {
    if (a == b) return false;
    Group both;
    both.members = state_.trace.unionOf(held_[a].members, held_[b].members);
    state_.trace.keep(both.members);
    both.trace = mixed(StepKind::Joined, held_[a].trace + held_[b].trace);
    held_[a].is_linked = held_[b].is_linked = both.is_linked = true;
    both.fragments = held_[a].fragments;
    both.fragments.insert(both.fragments.end(), held_[b].fragments.begin(), held_[b].fragments.end());
    if (!limits().empty()) {
      Candidate candidate;
      if (by_outline_) {
        both.outline = unionOf(std::array<const Outline*, 2>{&held_[a].outline, &held_[b].outline});
        setAttributes(both.outline, candidate.shape);
        candidate.fragments = {both.fragments.front()};  // whose tile the tests belong to
      } else {
        candidate = state_.fragments.candidateOf(both.fragments);
      }
      if (!passes(state_, rule_, limits(), std::move(candidate))) {
        noteRefusal(held_[a], held_[b]);
        return true;
      }
    }
    const auto [keep, drop] = std::minmax(a, b);
    held_[keep] = std::move(both);
    held_[drop] = {};
    sets_.join(keep, drop);
    return true;
  }

  ReasoningState& state_;
  const Rule& rule_;
  const std::vector<FragmentIndex>& members_;
  DisjointSets sets_;
  std::vector<Group> held_;
  bool by_outline_;
};

/// Free fragments that may be members of a group, in canonical order.
std::vector<FragmentIndex> members(const ReasoningState& state, const Rule& rule,
                                   const std::vector<FragmentIndex>& slices) {
  const std::size_t count = rule.seed.slice ? slices.size() : state.fragments.size();
  const auto numbered = [&](std::size_t i) { return rule.seed.slice ? slices[i] : static_cast<FragmentIndex>(i); };
  const auto mayBeMember = [&](FragmentIndex fragment) {
    if (!state.fragments[fragment].alive || state.fragments[fragment].owner != kFree) return false;
    const scan::PrimitiveLabel label = state.fragments.labelOf(fragment);
    return isIn(rule.seed.labels, label) || (rule.group && isIn(rule.group->labels, label));
  };
  // For sliced seeds the conditions were tested on the whole fragment before it was cut.
  const bool is_tested = !rule.seed.slice && !rule.seed.where.empty();
  constexpr std::size_t kTogether = 256;
  std::vector<char> is_member(count, 0);  // bytes, written in parallel
  parallelFor((count + kTogether - 1) / kTogether, state.threads(), [&](std::size_t chunk) {
    Bindings bindings;
    Candidate& candidate = bindings.candidates.emplace_back(rule.seed.name, Candidate{}).second;
    ConditionEvaluator evaluator(state, rule, bindings);
    const auto passes = [&](FragmentIndex fragment) {
      candidate.fragments.assign(1, fragment);
      candidate.shape = state.fragments.shapeOf(fragment);
      return evaluator.allHold(rule.seed.where);
    };
    const std::size_t end = std::min(count, (chunk + 1) * kTogether);
    for (std::size_t i = chunk * kTogether; i < end; ++i)
      is_member[i] = mayBeMember(numbered(i)) && (!is_tested || passes(numbered(i))) ? 1 : 0;
  });
  std::vector<FragmentIndex> found;
  for (std::size_t i = 0; i < count; ++i)
    if (is_member[i] != 0) found.push_back(numbered(i));
  std::sort(found.begin(), found.end(), [&](FragmentIndex a, FragmentIndex b) { return state.fragments.before(a, b); });
  return found;
}

}  // namespace

SliceScope::SliceScope(ReasoningState& state, const Rule& rule) : state_(state) {
  if (!rule.seed.slice) return;
  const FragmentIndex count = static_cast<FragmentIndex>(state.fragments.size());
  for (FragmentIndex fragment = 0; fragment < count; ++fragment) {
    const Fragment& whole = state.fragments[fragment];
    if (!whole.alive || whole.owner != kFree || !isIn(rule.seed.labels, state.fragments.labelOf(fragment))) continue;
    if (!passes(state, rule, rule.seed.where, state.fragments.candidateOf({fragment}))) continue;
    std::vector<std::uint32_t> inside, outside;
    for (std::uint32_t cluxel : whole.cluxels)
      (isWithin(state.scene.cluxels, cluxel, *rule.seed.slice) ? inside : outside).push_back(cluxel);
    if (inside.empty()) continue;
    auto parts = connectedBunches(state.scene.cluxels, inside);
    const bool has_rest = !outside.empty();
    if (has_rest) parts.insert(parts.begin(), std::move(outside));
    std::vector<FragmentIndex> made = state.cut(fragment, std::move(parts));
    slices_.insert(slices_.end(), made.begin() + (has_rest ? 1 : 0), made.end());
    if (has_rest)
      cuts_.push_back({made.front(), {made.begin() + 1, made.end()}});
    else
      cuts_.push_back({std::nullopt, made});
  }
  std::sort(slices_.begin(), slices_.end(),
            [&](FragmentIndex a, FragmentIndex b) { return state.fragments.before(a, b); });
}

void SliceScope::putBack() {
  auto isFree = [this](FragmentIndex fragment) {
    return state_.fragments[fragment].alive && state_.fragments[fragment].owner == kFree;
  };
  for (Cut& cut : cuts_) {
    std::optional<FragmentIndex> home = cut.rest;
    std::vector<FragmentIndex> free_slices;
    for (FragmentIndex slice : cut.slices)
      if (isFree(slice)) free_slices.push_back(slice);
    if (!home && !free_slices.empty()) {
      home = free_slices.front();
      free_slices.erase(free_slices.begin());
    }
    if (home) state_.join(*home, free_slices);
  }
  cuts_.clear();
}

std::vector<std::vector<FragmentIndex>> seedGroups(ReasoningState& state, const Rule& rule,
                                                   const std::vector<FragmentIndex>& slices, KnownLinks* known) {
  const std::vector<FragmentIndex> pool = members(state, rule, slices);
  std::vector<std::vector<FragmentIndex>> groups;
  if (rule.group)
    groups = Joining(state, rule, pool).groups(seedLinks(state, *rule.group, pool, known));
  else
    for (FragmentIndex fragment : pool) groups.push_back({fragment});
  std::erase_if(groups, [&](const auto& group) {
    return std::none_of(group.begin(), group.end(), [&](FragmentIndex fragment) {
      return isIn(rule.seed.labels, state.fragments.labelOf(fragment));
    });
  });
  auto points = [&](const auto& group) {
    double sum = 0;
    for (FragmentIndex fragment : group) sum += state.fragments.shapeOf(fragment).points;
    return sum;
  };
  for (auto& group : groups)
    std::sort(group.begin(), group.end(),
              [&](FragmentIndex a, FragmentIndex b) { return state.fragments.before(a, b); });
  std::sort(groups.begin(), groups.end(), [&](const auto& a, const auto& b) {
    const double points_a = points(a), points_b = points(b);
    return points_a != points_b ? points_a > points_b : state.fragments.before(a.front(), b.front());
  });
  return groups;
}

}  // namespace cluxel::rules
