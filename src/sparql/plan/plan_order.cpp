// SPDX-License-Identifier: Apache-2.0
// Plans ORDER BY: with LIMIT, BINDs are evaluated for the kept rows only, and the nearest geometries are read first.
#include <algorithm>

#include "rdf/store/geometry_index.hpp"
#include "sparql/plan/planner.hpp"
#include "sparql/plan/range_finder.hpp"

namespace cluxel::sparql {
namespace {

/// Rows around which the nearest geometries are searched at most, as estimated.
constexpr double kMaxPlaces = 16;
/// The cost of a candidate in rows of the whole pattern.
constexpr double kCostOfCandidate = 6;

bool isGroupPattern(const Node& node) {
  switch (node.kind) {
    case Node::Kind::Triple:
    case Node::Kind::Join:
    case Node::Kind::Filter:
    case Node::Kind::LeftJoin:
    case Node::Kind::Extend:
      return true;
    default:
      return false;
  }
}

/// The pattern `?thing <predicate> ?geometry`, if there is one.
const Node* patternOf(Slot geometry, const std::vector<const Node*>& parts) {
  const auto found = std::find_if(parts.begin(), parts.end(), [&](const Node* part) {
    const TripleNode& triple = part->triple;
    return part->kind == Node::Kind::Triple && !triple.path && triple.object.slot == geometry &&
           !triple.predicate.isSlot() && triple.predicate.constant < kFirstComputed;
  });
  return found == parts.end() ? nullptr : *found;
}

}  // namespace

Planner::State Planner::order(const Node& node, std::optional<std::uint64_t> max_rows,
                              const std::vector<Slot>& columns) {
  const Node* child = node.children[0].get();
  std::vector<SortKey> keys = node.sort_keys;
  std::vector<const Node*> late;
  if (max_rows && spatial_plans_) late = lateBinds(child, keys);
  std::vector<Expr> ties;
  for (const Slot slot : columns) ties.push_back(tieOf(slot, late));
  auto nearest = max_rows && spatial_plans_ ? nearestFirst(*child, keys.front(), *max_rows) : std::nullopt;
  State state = nearest ? std::move(*nearest) : alone(*child);
  std::vector<const Expr*> expressions;
  for (const SortKey& key : keys) expressions.push_back(&key.expression);
  auto exists = planExists(state, expressions);
  const double rows = max_rows ? std::min(state.rows, static_cast<double>(*max_rows)) : state.rows;
  state.top = makeOrder(std::move(state.top), std::move(keys), std::move(ties), max_rows, std::move(exists));
  state.sorted_by = kNoSlot;
  setRows(state, rows);
  return late.empty() ? std::move(state) : extend(std::move(state), late);
}

/// Takes BINDs off the pattern, and puts their expressions into the keys that use them.
std::vector<const Node*> Planner::lateBinds(const Node*& child, std::vector<SortKey>& keys) const {
  std::vector<const Node*> late;
  const bool are_plain = std::all_of(
      keys.begin(), keys.end(), [](const SortKey& key) { return readsOnly(key.expression, key.expression.slots()); });
  if (!are_plain) return late;
  for (; child->kind == Node::Kind::Extend; child = child->children[0].get()) {
    const Expr& expression = *child->expression;
    const bool is_parameter = std::find(parameters_.begin(), parameters_.end(), child->slot) != parameters_.end();
    if (is_parameter || child->children[0]->possible.has(child->slot) || !readsOnly(expression, expression.slots()))
      break;
    late.insert(late.begin(), child);
  }
  BoundExpressions expressions;
  for (const Node* bind : late) expressions[bind->slot] = &*bind->expression;
  for (SortKey& key : keys) key.expression = expanded(key.expression, expressions);
  return late;
}

/// Rows with equal keys are compared by this expression.
Expr Planner::tieOf(Slot slot, const std::vector<const Node*>& late) {
  BoundExpressions expressions;
  for (const Node* bind : late) expressions[bind->slot] = &*bind->expression;
  Expr tie;
  tie.kind = Expr::Kind::Slot;
  tie.slot = slot;
  return expanded(tie, expressions);
}

/// Plans ORDER BY distance(?geometry, place) with a LIMIT by the stored index; none when sorting is cheaper.
std::optional<Planner::State> Planner::nearestFirst(const Node& body, const SortKey& key, std::uint64_t max_rows) {
  const GeometryPair pair = distanceArguments(key.expression, terms_);
  if (pair.first == nullptr || key.descending || !isGroupPattern(body)) return std::nullopt;
  for (const auto& [geometry, place] : {std::pair(pair.first, pair.second), std::pair(pair.second, pair.first)}) {
    if (geometry->kind != Expr::Kind::Slot || !body.certain.has(geometry->slot)) continue;
    if (auto state = nearestFirst(body, geometry->slot, *place, max_rows)) return state;
  }
  return std::nullopt;
}

std::optional<Planner::State> Planner::nearestFirst(const Node& body, Slot geometry, const Expr& place,
                                                    std::uint64_t max_rows) {
  const State start = unit();
  Parts parts;
  for (const Slot slot : parameters_) parts.constant.add(slot);
  if (!unsure_parameters_.empty() || !readsOnly(place, place.slots())) return std::nullopt;
  takeApart(body, {}, {}, parts);
  const Node* pattern = patternOf(geometry, parts.joined);
  if (pattern == nullptr) return std::nullopt;
  Waiting places;
  const SlotSet needed = place.slots() - start.possible;
  for (const Waiting& component : componentsOf(start, parts.joined)) {
    SlotSet certain;
    for (const Node* part : component) certain.add(part->certain);
    if (certain.intersects(needed)) places.insert(places.end(), component.begin(), component.end());
  }
  SlotSet of_places;
  for (const Node* part : places) of_places.add(part->certain);
  if (!of_places.contains(needed) || of_places.has(geometry)) return std::nullopt;
  Parts of_place = taken(places, parts, of_places);
  State around = joinParts(unit(), of_place);
  if (around.rows > kMaxPlaces) return std::nullopt;
  const double rows = alone(body).rows;
  const auto index = reader_.geometries();
  const double candidates =
      around.rows * static_cast<double>(index->loose().size()) +
      static_cast<double>(max_rows) * static_cast<double>(index->size()) * around.rows / std::max(rows, 1.0);
  if (candidates * kCostOfCandidate > rows) return std::nullopt;
  std::erase_if(parts.joined,
                [&](const Node* part) { return std::find(places.begin(), places.end(), part) != places.end(); });
  return nearestSource(std::move(around), parts, {geometry, place, pattern->triple.predicate.constant}, rows);
}

Planner::State Planner::nearestSource(State around, Parts& parts, NearestScan scan, double rows) {
  Pipeline body;
  body.origin = freshSlot(".row");
  auto input = std::make_unique<InputOperator>(mergedSlots(around.top->slots(), {scan.slot}), body.origin);
  body.input = input.get();
  State inner;
  inner.top = std::move(input);
  inner.certain = around.certain;
  inner.possible = around.possible;
  inner.certain.add(scan.slot);
  inner.possible.add(scan.slot);
  inner.is_unit = false;
  inner.is_input = true;
  setRows(inner, 64);
  inner = joinParts(std::move(inner), parts);
  body.top = std::move(inner.top);
  State state;
  state.top = makeNearestSource(std::move(around.top), std::move(body), std::move(scan));
  state.certain = inner.certain;
  state.possible = inner.possible;
  state.is_unit = false;
  setRows(state, rows);
  return state;
}

}  // namespace cluxel::sparql
