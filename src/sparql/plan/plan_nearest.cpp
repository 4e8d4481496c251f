// SPDX-License-Identifier: Apache-2.0
// Recognises "no other is nearer": FILTER NOT EXISTS { … FILTER(distance(a, other) < distance(a, b)) }.
#include <algorithm>

#include "sparql/plan/planner.hpp"
#include "sparql/plan/range_finder.hpp"

namespace cluxel::sparql {
namespace {

using Kind = Expr::Kind;

/// The pattern of NOT EXISTS and its conditions.
const Node* absentPattern(const Expr& condition) {
  if (condition.kind == Kind::NotExists) return condition.pattern.get();
  const bool negated = condition.kind == Kind::Not && condition.arguments[0].kind == Kind::Exists;
  return negated ? condition.arguments[0].pattern.get() : nullptr;
}

/// The two sides of "lesser is less than greater".
struct Comparison {
  const Expr* lesser = nullptr;
  const Expr* greater = nullptr;
};
Comparison comparisonOf(const Expr& condition) {
  switch (condition.kind) {
    case Kind::Less:
    case Kind::LessEqual:
      return {&condition.arguments[0], &condition.arguments[1]};
    case Kind::Greater:
    case Kind::GreaterEqual:
      return {&condition.arguments[1], &condition.arguments[0]};
    default:
      return {};
  }
}

/// The slot among `slots` of a pair of geometries, and the other geometry.
struct Measured {
  Slot slot = kNoSlot;
  const Expr* place = nullptr;
};
Measured measuredIn(const GeometryPair& pair, const SlotSet& slots) {
  if (pair.first == nullptr) return {};
  if (pair.first->kind == Kind::Slot && slots.has(pair.first->slot)) return {pair.first->slot, pair.second};
  if (pair.second->kind == Kind::Slot && slots.has(pair.second->slot)) return {pair.second->slot, pair.first};
  return {};
}

/// The inner slot of ?inner != ?outer.
Slot distinguishedBy(const Expr& condition, const SlotSet& inner, const SlotSet& outer) {
  if (condition.kind != Kind::NotEqual) return kNoSlot;
  const Expr &a = condition.arguments[0], &b = condition.arguments[1];
  if (a.kind != Kind::Slot || b.kind != Kind::Slot) return kNoSlot;
  if (inner.has(a.slot) && outer.has(b.slot)) return a.slot;
  return inner.has(b.slot) && outer.has(a.slot) ? b.slot : kNoSlot;
}

/// True when the slot is the subject of a pattern, hence no literal.
bool isSubject(const Node& node, Slot slot) {
  if (node.kind == Node::Kind::Triple) return !node.triple.path && node.triple.subject.slot == slot;
  return node.kind == Node::Kind::Join && std::any_of(node.children.begin(), node.children.end(),
                                                      [&](const NodePtr& child) { return isSubject(*child, slot); });
}

/// A condition that a slot is at most `count`.
struct CountBound {
  Slot slot;
  std::int64_t count;
};

std::optional<CountBound> greatestCount(const Expr& condition) {
  using Kind = Expr::Kind;
  if (condition.arguments.size() != 2) return std::nullopt;
  const bool is_turned = condition.arguments[0].kind == Kind::Constant;
  const Expr &slot = condition.arguments[is_turned ? 1 : 0], &number = condition.arguments[is_turned ? 0 : 1];
  const bool is_integer = number.kind == Kind::Constant && number.constant.type == Value::Type::Integer;
  if (slot.kind != Kind::Slot || !is_integer || number.constant.payload) return std::nullopt;
  const std::int64_t value = number.constant.integer;
  if (condition.kind == Kind::Equal) return CountBound{slot.slot, value};
  if (condition.kind == (is_turned ? Kind::Greater : Kind::Less)) return CountBound{slot.slot, value - 1};
  if (condition.kind == (is_turned ? Kind::GreaterEqual : Kind::LessEqual)) return CountBound{slot.slot, value};
  return std::nullopt;
}

}  // namespace

/// `probe` and `build` are the slots of the two geometries; `outside` all slots outside the pattern. Conditions of the
/// pattern other than the comparison and one ?other != ?thing are not understood, unless they concern the pattern only.
std::optional<NearestTest> Planner::nearestOf(const Expr& condition, const SlotSet& probe, const SlotSet& build,
                                              const SlotSet& outside) {
  const Node* pattern = absentPattern(condition);
  if (pattern == nullptr || pattern->kind != Node::Kind::Filter) return std::nullopt;
  const NodePtr& inner = pattern->children[0];
  if (inner->mentioned().intersects(outside)) return std::nullopt;
  SlotSet both = probe;
  both.add(build);
  std::optional<NearestTest> found;
  Slot distinguished = kNoSlot;
  NodePtr others = makeNode(Node::Kind::Filter, pattern->at);
  others->children = {inner};
  for (const Expr& inner_condition : pattern->conditions) {
    if (readsOnly(inner_condition, inner->certain)) {
      others->conditions.push_back(inner_condition);
      continue;
    }
    const Slot other_thing = distinguishedBy(inner_condition, inner->certain, both);
    if (distinguished == kNoSlot && other_thing != kNoSlot && isSubject(*inner, other_thing)) {
      distinguished = other_thing;
      continue;
    }
    const auto [lesser, greater] = comparisonOf(inner_condition);
    if (lesser == nullptr || found) return std::nullopt;
    const Measured near = measuredIn(distanceArguments(*lesser, terms_), inner->certain);
    const Measured far = measuredIn(distanceArguments(*greater, terms_), build);
    if (near.place == nullptr || far.place == nullptr || !readsOnly(*near.place, probe)) return std::nullopt;
    if (!isSame(*near.place, *far.place)) return std::nullopt;
    found = NearestTest{far.slot, *near.place, nullptr, near.slot, kNoSlot};
  }
  if (!found) return std::nullopt;
  found->distinguished = distinguished;
  others->annotate();
  NodePtr pattern_of_others = others->conditions.empty() ? inner : others;
  made_.push_back(pattern_of_others);
  found->others = alone(*pattern_of_others).top;
  return found;
}

/// For a group whose only aggregate is MIN(geof:distance(…)), or of a variable with that value.
std::optional<Planner::Closest> Planner::closestOf(const Node& group) {
  const Node::Kind kind = group.children[0]->kind;
  const bool is_pattern = kind == Node::Kind::Join || kind == Node::Kind::Filter || kind == Node::Kind::Extend;
  if (!is_pattern || group.aggregates.size() != 1) return std::nullopt;
  const AggregateSpec& aggregate = group.aggregates[0];
  if (aggregate.function != ast::AggregateFunction::Min || !aggregate.argument) return std::nullopt;
  Closest closest{*aggregate.argument, {}};
  for (const Slot key : group.slots) closest.keys.add(key);
  return closest;
}

/// Notes how many rows of a group are enough to know that HAVING refuses it: COUNT(?x) < 3 does so from three rows on.
void Planner::noteEnough(const Node& group, const std::vector<Expr>& having) {
  constexpr std::int64_t kMost = 1000;
  if (!spatial_plans_ || query_.is_volatile || !group.grouped_by_keys) return;
  for (const Expr& condition : having) {
    if (condition.kind == Expr::Kind::And) noteEnough(group, condition.arguments);
    const auto bound = greatestCount(condition);
    if (!bound || bound->count < 0 || bound->count >= kMost) continue;
    const auto counts = [&](const AggregateSpec& spec) {
      const bool is_simple = !spec.argument || spec.argument->kind == Expr::Kind::Slot;
      return spec.result == bound->slot && spec.function == ast::AggregateFunction::Count && is_simple &&
             (spec.argument || !spec.distinct);
    };
    const auto spec = std::find_if(group.aggregates.begin(), group.aggregates.end(), counts);
    if (spec == group.aggregates.end()) continue;
    const Slot counted = spec->argument ? spec->argument->slot : kNoSlot;
    enough_[&group] = {static_cast<std::uint64_t>(bound->count) + 1, group.slots, counted, spec->distinct, {}};
    return;
  }
}

/// Limits a join to the nearest geometries of one side, if nothing but the two sides decides which rows there are.
void Planner::addClosest(const State& state, const Waiting& waiting, const Parts& parts, const SlotSet& build,
                         const Expr& distance, RangeJoin& join) {
  const bool only_binds = std::all_of(parts.postponed.begin(), parts.postponed.end(),
                                      [](const Postponed& step) { return step.kind == Postponed::Kind::Extend; });
  const bool is_apart = std::all_of(parts.filters.begin(), parts.filters.end(), [&](const Expr& filter) {
    return readsOnly(filter, state.certain) || readsOnly(filter, build);
  });
  if (!only_binds || !is_apart || state.is_input || !join.tests.empty()) return;
  if (componentsOf(state, waiting).size() != 1) return;
  const auto find = [&](const SlotSet& place, const SlotSet& slots) -> std::optional<NearestTest> {
    const Measured pair = measuredIn(distanceArguments(distance, terms_), slots);
    if (pair.place == nullptr || !readsOnly(*pair.place, place) || !place.contains(parts.closest->keys))
      return std::nullopt;
    return NearestTest{pair.slot, *pair.place, nullptr, pair.slot, kNoSlot};
  };
  Waiting nodes = waiting;
  if (auto nearest = find(state.certain, build)) {
    join.nearest = std::move(nearest);
  } else if (auto reversed = find(build, state.certain)) {
    join.nearest = std::move(reversed);
    join.is_reversed = true;
    std::erase_if(nodes = parts.joined,
                  [&](const Node* node) { return std::find(waiting.begin(), waiting.end(), node) != waiting.end(); });
  }
  if (!join.nearest) return;
  Parts others = taken(nodes, parts, join.is_reversed ? state.certain : build);
  join.nearest->others = joinParts(unit(), others).top;
}

}  // namespace cluxel::sparql
