// SPDX-License-Identifier: Apache-2.0
// Plans independent parts: solution modifiers, VALUES, and GRAPH around sub-selects.
#include <algorithm>
#include <cmath>
#include <limits>

#include "sparql/plan/planner.hpp"

namespace cluxel::sparql {
namespace {

bool isModifier(const Node& node) {
  return node.kind == Node::Kind::OrderBy || node.kind == Node::Kind::Project || node.kind == Node::Kind::Distinct ||
         node.kind == Node::Kind::Slice;
}

/// offset + limit, saturating.
std::uint64_t plus(std::uint64_t a, std::uint64_t b) {
  return b > std::numeric_limits<std::uint64_t>::max() - a ? std::numeric_limits<std::uint64_t>::max() : a + b;
}

}  // namespace

OperatorPtr Planner::plan() {
  const Node& root = *query_.root;
  if (query_.wants_one && !isModifier(root) && root.kind != Node::Kind::Group) needed_rows_ = 1;
  return alone(root).top;
}
OperatorPtr Planner::planAlone(const Node& node) {
  return alone(node).top;
}

Planner::State Planner::alone(const Node& node) {
  if (isModifier(node) || node.kind == Node::Kind::Group) return select(node, std::nullopt, {});
  if (node.kind == Node::Kind::Values) return values(node);
  if (node.kind == Node::Kind::GraphLoop) return graphLoop(node);
  return joinNode(unit(), node, {});
}

Planner::State Planner::values(const Node& node) {
  State state;
  state.top = makeValues(node.slots, node.rows, node.note);
  state.top->at = node.at;
  state.certain = node.certain;
  state.possible = node.possible;
  state.is_unit = false;
  setRows(state, static_cast<double>(node.rows.count));
  if (parameters_.empty()) return state;
  return hashJoin(unit(), std::move(state));
}

Planner::State Planner::graphLoop(const Node& node) {
  parameters_.push_back(node.graph.slot);
  State state = alone(*node.children[0]);
  parameters_.pop_back();
  state.top = makeGraphLoop(std::move(state.top), node.graph.slot);
  state.certain.add(node.graph.slot);
  state.possible.add(node.graph.slot);
  state.sorted_by = kNoSlot;
  return state;
}

Planner::State Planner::select(const Node& node, std::optional<std::uint64_t> max_rows,
                               const std::vector<Slot>& columns) {
  switch (node.kind) {
    case Node::Kind::Slice:
      return slice(node, columns);
    case Node::Kind::Distinct:
      return distinct(node);
    case Node::Kind::Project:
      return project(node, max_rows);
    case Node::Kind::OrderBy:
      return order(node, max_rows, columns);
    default:
      return group(node);
  }
}

/// Pushes the row limit and the tie-breaking columns down to the sort.
Planner::State Planner::belowModifier(const Node& child, std::optional<std::uint64_t> max_rows,
                                      const std::vector<Slot>& columns) {
  return isModifier(child) ? select(child, max_rows, columns) : alone(child);
}

Planner::State Planner::slice(const Node& node, const std::vector<Slot>& columns) {
  const Node& child = *node.children[0];
  std::optional<std::uint64_t> rows_needed;
  if (node.limit && child.kind != Node::Kind::Distinct) rows_needed = plus(node.offset, *node.limit);
  const bool cuts_group = child.kind == Node::Kind::Project && !isModifier(*child.children[0]);
  if (rows_needed && cuts_group) needed_rows_ = static_cast<double>(*rows_needed);
  State state = belowModifier(child, rows_needed, columns);
  needed_rows_ = kAllRows;
  const double rows = node.limit ? std::min(state.rows, static_cast<double>(*node.limit)) : state.rows;
  state.top = makeSlice(std::move(state.top), node.offset, node.limit);
  setRows(state, rows);
  return state;
}

Planner::State Planner::distinct(const Node& node) {
  State state = belowModifier(*node.children[0], std::nullopt, node.slots);
  std::vector<Slot> slots = node.slots;
  for (const Slot slot : parameters_) slots.push_back(slot);
  state.top = makeDistinct(std::move(state.top), mergedSlots(slots, {}));
  setRows(state, state.rows);
  return state;
}

Planner::State Planner::project(const Node& node, std::optional<std::uint64_t> max_rows) {
  State state = belowModifier(*node.children[0], max_rows, node.slots);
  std::vector<Slot> slots = node.slots;
  for (const Slot slot : parameters_) slots.push_back(slot);
  SlotSet kept;
  for (const Slot slot : slots) kept.add(slot);
  state.top = makeProject(std::move(state.top), slots);
  state.certain = state.certain & kept;
  state.possible = state.possible & kept;
  setRows(state, state.rows);
  return state;
}

Planner::State Planner::group(const Node& node) {
  closest_ = closestOf(node);
  State state = alone(*node.children[0]);
  std::vector<const Expr*> expressions;
  for (const AggregateSpec& aggregate : node.aggregates) {
    if (aggregate.argument) expressions.push_back(&*aggregate.argument);
  }
  auto exists = planExists(state, expressions);
  const auto enough = enough_.find(&node);
  if (enough != enough_.end() && exists.empty()) state.top->stopAfter(enough->second);
  State grouped;
  const std::vector<Slot> keys = mergedSlots(node.slots, {});
  grouped.top =
      makeGroup(std::move(state.top), keys, node.aggregates, node.grouped_by_keys, parameters_, std::move(exists));
  grouped.certain = node.certain;
  grouped.possible = node.possible;
  for (const Slot slot : parameters_) {
    if (!unsure_parameters_.has(slot)) grouped.certain.add(slot);
    grouped.possible.add(slot);
  }
  grouped.is_unit = false;
  setRows(grouped, node.grouped_by_keys ? std::max(1.0, std::sqrt(state.rows) * 4) : 1);
  return grouped;
}

}  // namespace cluxel::sparql
