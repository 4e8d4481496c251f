// SPDX-License-Identifier: Apache-2.0
// Joins parts that share no variable by FILTERs on distances and numbers, in place of all with all.
#include <algorithm>
#include <cmath>

#include "rdf/store/geometry_index.hpp"
#include "sparql/plan/planner.hpp"
#include "sparql/plan/range_finder.hpp"

namespace cluxel::sparql {
namespace {

/// A connected part is joined later if it multiplies the rows by more.
constexpr double kManyRows = 50;
/// The assumed number of candidates of a row, and the share of rows that a test leaves at least.
constexpr double kCandidates = 8, kShareKept = 0.002;
/// Costs in nanoseconds: reading a geometry of the build side; a search in its tree; a search in the stored index and a
/// lookup of each candidate.
constexpr double kGeometryRead = 1500, kTreeSearch = 1000, kIndexSearch = 6000;

/// The slots of BINDs that nothing else binds, with their expressions.
BoundExpressions bindsOf(const std::vector<const Node*>& binds, const SlotSet& bound_otherwise) {
  BoundExpressions expressions;
  for (const Node* bind : binds) {
    const Expr& expression = *bind->expression;
    SlotSet all = expression.slots();
    if (!bound_otherwise.has(bind->slot) && readsOnly(expression, all)) expressions[bind->slot] = &expression;
  }
  return expressions;
}

/// False for tests against constants, which tie no two sides.
bool readsRow(const RangeTest& test) {
  if (test.place && !test.place->slots().empty()) return true;
  return std::any_of(test.bound.parts.begin(), test.bound.parts.end(),
                     [](const RowSum::Part& part) { return !part.expression.slots().empty(); });
}

bool isDistance(const RangeTest& test) {
  return test.kind == RangeTest::Kind::Near;
}

SlotSet certainOf(const std::vector<const Node*>& parts) {
  SlotSet certain;
  for (const Node* part : parts) certain.add(part->certain);
  return certain;
}

SlotSet possibleOf(const std::vector<const Node*>& parts) {
  SlotSet possible;
  for (const Node* part : parts) possible.add(part->possible);
  return possible;
}

}  // namespace

/// True when every remaining part multiplies the rows.
bool Planner::blowsUp(const State& state, const Waiting& waiting) {
  return std::none_of(waiting.begin(), waiting.end(), [&](const Node* part) {
    return state.possible.intersects(part->possible) && rowsAfter(state, *part) <= state.rows * kManyRows;
  });
}

/// Groups the parts that share variables which the rows so far do not have.
std::vector<Planner::Waiting> Planner::componentsOf(const State& state, const Waiting& waiting) const {
  std::vector<Waiting> components;
  std::vector<SlotSet> slots;
  for (const Node* part : waiting) {
    SlotSet own = part->possible - state.possible;
    Waiting merged;
    for (std::size_t i = components.size(); i-- > 0;) {
      if (!slots[i].intersects(own)) continue;
      own.add(slots[i]);
      merged.insert(merged.begin(), components[i].begin(), components[i].end());
      components.erase(components.begin() + static_cast<std::ptrdiff_t>(i));
      slots.erase(slots.begin() + static_cast<std::ptrdiff_t>(i));
    }
    merged.push_back(part);
    components.push_back(std::move(merged));
    slots.push_back(std::move(own));
  }
  return components;
}

std::optional<Planner::State> Planner::joinByRange(State& state, Waiting& waiting, const Parts& parts,
                                                   std::vector<bool>& used) {
  const bool has_conditions = !parts.filters.empty() || parts.closest;
  if (!spatial_plans_ || state.is_unit || !has_conditions || !blowsUp(state, waiting)) return std::nullopt;
  std::optional<RangeJoin> best;
  Waiting best_component;
  for (const Waiting& component : componentsOf(state, waiting)) {
    auto join = rangeJoinWith(state, component, waiting, parts, used);
    if (!join || (best && best->other.rows <= join->other.rows)) continue;
    best = std::move(join);
    best_component = component;
  }
  if (!best) return std::nullopt;
  if (auto by_index = joinByIndex(state, *best, best_component)) return by_index;
  used = best->used;
  std::erase_if(waiting, [&](const Node* part) {
    return std::find(best_component.begin(), best_component.end(), part) != best_component.end();
  });
  return finishRange(std::move(state), std::move(*best));
}

std::optional<Planner::RangeJoin> Planner::rangeJoinWith(const State& state, const Waiting& component,
                                                         const Waiting& waiting, const Parts& parts,
                                                         const std::vector<bool>& used) {
  for (const Node* part : component) {
    if (!seenFromOutside(state, *part).empty()) return std::nullopt;
  }
  const SlotSet shared = state.possible & possibleOf(component), certain = certainOf(component);
  if (!certain.contains(shared) || !state.certain.contains(shared)) return std::nullopt;
  const RangeSides sides = sidesOf(state, component, waiting, parts);
  RangeJoin join;
  join.used = used;
  addTests(state, sides, parts, join);
  if (parts.closest && !join.nearest && shared.empty())
    addClosest(state, waiting, parts, sides.other, expanded(parts.closest->distance, sides.binds), join);
  // Where the sides share a variable, lookups by it are cheaper than a range of numbers.
  const bool has_distance = join.nearest || std::any_of(join.tests.begin(), join.tests.end(), isDistance);
  if (!has_distance && (join.tests.empty() || !shared.empty())) return std::nullopt;
  Parts within = taken(component, parts, sides.other);
  for (std::size_t i = 0; i < parts.filters.size(); ++i)
    join.used[i] = used[i] || readsOnly(parts.filters[i], sides.other);
  join.other = joinParts(unit(), within);
  return join;
}

Planner::RangeSides Planner::sidesOf(const State& state, const Waiting& component, const Waiting& waiting,
                                     const Parts& parts) const {
  Waiting rest = waiting;
  std::erase_if(
      rest, [&](const Node* part) { return std::find(component.begin(), component.end(), part) != component.end(); });
  SlotSet after = possibleOf(rest);
  std::vector<const Node*> binds;
  for (const Postponed& step : parts.postponed) {
    if (step.kind == Postponed::Kind::LeftJoin) after.add(step.node->children[1]->possible);
    if (step.kind == Postponed::Kind::Extend) binds.push_back(step.node);
  }
  const SlotSet certain = certainOf(component), possible = possibleOf(component);
  RangeSides sides;
  sides.other = certain - state.possible;
  // An unbound variable fails the filter, unless a later part binds it.
  sides.given = state.possible - possible - after;
  sides.given.add(state.certain);
  sides.given_by_other = possible - state.possible - after;
  sides.given_by_other.add(sides.other);
  sides.outside = state.possible;
  sides.outside.add(possible);
  sides.outside.add(after);
  sides.binds = bindsOf(binds, sides.outside);
  for (const Node* bind : binds) sides.outside.add(bind->slot);
  return sides;
}

/// Collects tests of the component by the rows so far; if there are none, of the rows so far by the component.
void Planner::addTests(const State& state, const RangeSides& sides, const Parts& parts, RangeJoin& join) {
  std::vector<RangeTest> reversed;
  const auto add = [&](const Expr& condition, const JoinSides& slots, std::vector<RangeTest>& tests) {
    for (RangeTest& test : rangeTestsOf(condition, slots, terms_))
      if (readsRow(test)) tests.push_back(std::move(test));
  };
  const bool may_reverse = !state.is_input;
  for (std::size_t i = 0; i < parts.filters.size(); ++i) {
    if (join.used[i]) continue;
    const Expr condition = expanded(parts.filters[i], sides.binds);
    add(condition, {sides.given, sides.other}, join.tests);
    if (may_reverse) add(condition, {sides.given_by_other, state.certain}, reversed);
    if (join.nearest) continue;
    join.nearest = nearestOf(condition, state.certain, sides.other, sides.outside);
    if (join.nearest || !may_reverse) continue;
    join.nearest = nearestOf(condition, sides.other, state.certain, sides.outside);
    join.is_reversed = join.nearest.has_value();
  }
  if (join.tests.empty() && !join.nearest && !reversed.empty()) join.is_reversed = true;
  if (join.is_reversed) join.tests = std::move(reversed);
}

/// Some nodes of a group as a group of their own, with the filters that read their slots only.
Planner::Parts Planner::taken(const Waiting& nodes, const Parts& parts, const SlotSet& slots) const {
  Parts part;
  part.joined = nodes;
  for (const Expr& filter : parts.filters) {
    if (readsOnly(filter, slots)) part.filters.push_back(filter);
  }
  return part;
}

Planner::State Planner::finishRange(State state, RangeJoin join) {
  if (join.is_reversed) std::swap(state, join.other);
  const double candidates = std::max(kCandidates, join.other.rows * kShareKept);
  const double rows = state.rows * std::min(join.other.rows, candidates);
  state.top =
      makeRangeJoin(std::move(state.top), std::move(join.other.top), std::move(join.tests), std::move(join.nearest));
  state.certain.add(join.other.certain);
  state.possible.add(join.other.possible);
  state.is_unit = false;
  setRows(state, rows);
  return state;
}

/// Finds the candidates of few rows in the index of stored geometries, when that is cheaper than reading all rows of
/// the component. Its patterns then look the candidates up.
std::optional<Planner::State> Planner::joinByIndex(State& state, const RangeJoin& join, const Waiting& component) {
  const auto near = std::find_if(join.tests.begin(), join.tests.end(), isDistance);
  if (near == join.tests.end() || join.nearest || join.is_reversed) return std::nullopt;
  const bool is_object = std::any_of(component.begin(), component.end(), [&](const Node* part) {
    return part->kind == Node::Kind::Triple && !part->triple.path && part->triple.object.slot == near->slot;
  });
  if (!is_object) return std::nullopt;
  const double by_index = state.rows * kIndexSearch;
  const double by_rows = join.other.rows * kGeometryRead + state.rows * kTreeSearch;
  if (by_index > by_rows) return std::nullopt;
  const auto index = reader_.geometries();
  if (static_cast<double>(index->loose().size()) > join.other.rows / 8) return std::nullopt;
  const double rows = state.rows * std::min(static_cast<double>(index->size()), kCandidates);
  State next = std::move(state);
  next.top = makeNearLookup(std::move(next.top), *near);
  next.certain.add(near->slot);
  next.possible.add(near->slot);
  setRows(next, rows);
  return next;
}

}  // namespace cluxel::sparql
