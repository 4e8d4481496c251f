// SPDX-License-Identifier: Apache-2.0
// Plans of single steps: which join for which pattern, optionals, minus, binds, and the modifiers of SELECT.
#include <algorithm>
#include <cmath>

#include "sparql/pattern_access.hpp"
#include "sparql/planner.hpp"

namespace cluxel::sparql {
namespace {

// Measured on this store, in nanoseconds: a lookup by ascending and by scattered ids, an entry read in a scan, a row
// put into and looked up in a hash table.
constexpr double kAscendingLookup = 120, kScatteredLookup = 350, kScannedEntry = 4, kHashBuild = 35, kHashProbe = 25,
                 kMergedRow = 8;

BoundMask constantsOf(const TripleNode& pattern, const Dataset& dataset) {
  BoundMask mask = 0;
  if (!pattern.subject.isSlot()) mask |= 1;
  if (!pattern.predicate.isSlot()) mask |= 2;
  if (!pattern.object.isSlot()) mask |= 4;
  const bool one_default = pattern.graph.kind == GraphPlace::Kind::Default &&
                           dataset.default_graph.kind == GraphFilter::Kind::One;
  if (pattern.graph.kind == GraphPlace::Kind::Constant || one_default) mask |= 8;
  return mask;
}

/// The slot by which a scan in this order ascends.
Slot sortedBy(const TripleNode& pattern, const OrderChoice& choice) {
  if (choice.prefix >= 4) return kNoSlot;
  const QuadPlaces places = placesOfPattern(pattern);
  return places[placesOf(choice.order)[choice.prefix]].slot;
}

bool isImpossible(const TripleNode& pattern, const Dataset& dataset) {
  const auto missing = [](const PatternPlace& place) { return !place.isSlot() && place.constant >= kFirstComputed; };
  if (pattern.graph.kind == GraphPlace::Kind::Constant &&
      !std::binary_search(dataset.named.begin(), dataset.named.end(), pattern.graph.constant)) {
    return true;
  }
  if (pattern.graph.kind == GraphPlace::Kind::Slot && dataset.named.empty()) return true;
  if (pattern.path) return false;
  return missing(pattern.subject) || missing(pattern.predicate) || missing(pattern.object);
}

}  // namespace

Planner::State Planner::joinPart(State state, const Node& part) {
  switch (part.kind) {
    case Node::Kind::Triple: return joinTriple(std::move(state), part);
    case Node::Kind::Union: return joinUnion(std::move(state), part);
    case Node::Kind::GraphNames: {
      const double rows = rowsAfter(state, part);
      state.top = makeGraphNames(std::move(state.top), part.graph);
      state.certain.add(part.certain);
      state.possible.add(part.possible);
      state.is_unit = false;
      setRows(state, rows);
      return state;
    }
    default: return joinAlone(std::move(state), part);
  }
}

Planner::State Planner::joinTriple(State state, const Node& part) {
  const TripleNode& pattern = part.triple;
  const double rows = rowsAfter(state, part);
  const SlotSet certain_before = state.certain;
  const auto finish = [&](OperatorPtr top) {
    state.top = std::move(top);
    state.top->at = part.at;
    state.certain.add(part.certain);
    state.possible.add(part.possible);
    state.is_unit = false;
    setRows(state, rows);
    return std::move(state);
  };
  if (isImpossible(pattern, dataset_)) {
    const auto slots = mergedSlots(state.top->slots(), part.possible.list());
    return finish(std::make_unique<NothingOperator>(std::move(state.top), pattern, slots));
  }
  if (pattern.path) {
    state.sorted_by = kNoSlot;
    return finish(makePathJoin(std::move(state.top), pattern));
  }
  const OrderChoice scan = chooseOrder(constantsOf(pattern, dataset_));
  if (state.is_unit) {
    state.sorted_by = sortedBy(pattern, scan);
    return finish(makeScan(pattern, scan.order));
  }
  const std::vector<Slot> keys = (part.possible & certain_before).list();
  const double own = cardinality_.matches(pattern);
  const bool ascending = state.sorted_by != kNoSlot && part.possible.has(state.sorted_by);
  const double lookup_cost = state.rows * (ascending ? kAscendingLookup : kScatteredLookup);
  const double hash_cost = own * (kScannedEntry + kHashBuild) + state.rows * kHashProbe;
  const std::vector<Slot> shared = (part.possible & state.possible).list();
  const double merge_cost = own * kScannedEntry + state.rows * kMergedRow;
  const bool can_merge = ascending && sortedBy(pattern, scan) == state.sorted_by && shared == keys && !state.is_input;
  if (can_merge && merge_cost < std::min(lookup_cost, hash_cost)) {
    auto other = makeScan(pattern, scan.order);
    other->estimated_rows = own;
    const Slot slot = state.sorted_by;
    return finish(makeMergeJoin(std::move(state.top), std::move(other), slot));
  }
  if (!keys.empty() && !state.substituted && hash_cost < lookup_cost) {
    std::vector<Slot> compared;
    std::set_difference(shared.begin(), shared.end(), keys.begin(), keys.end(), std::back_inserter(compared));
    auto build = makeScan(pattern, scan.order);
    build->estimated_rows = own;
    return finish(makeHashJoin(std::move(state.top), std::move(build), keys, compared));
  }
  return finish(makeQuadJoin(std::move(state.top), pattern, false));
}

Planner::State Planner::joinUnion(State state, const Node& part) {
  const double own = cardinality_.rows(part);
  const bool connected = state.certain.intersects(part.certain);
  // Where the branches are small beside the rows so far, they are computed once.
  if (!state.is_unit && !state.substituted && connected && own * (kScannedEntry + kHashBuild) < state.rows * kAscendingLookup) {
    return joinAlone(std::move(state), part);
  }
  const double rows = rowsAfter(state, part);
  if (state.is_unit) {
    std::vector<OperatorPtr> alternatives;
    for (const NodePtr& branch : part.children) alternatives.push_back(alone(*branch).top);
    State both;
    both.top = makeConcat(std::move(alternatives));
    both.certain = part.certain;
    both.possible = part.possible;
    both.is_unit = false;
    setRows(both, rows);
    return both;
  }
  std::vector<Pipeline> branches;
  for (const NodePtr& branch : part.children) {
    branches.push_back(pipeline(state, false, [&](State inner) {
      return joinNode(std::move(inner), *branch, {});
    }));
  }
  state.top = makeUnion(std::move(state.top), std::move(branches));
  state.top->at = part.at;
  state.certain.add(part.certain);
  state.possible.add(part.possible);
  state.sorted_by = kNoSlot;
  state.is_unit = false;
  setRows(state, rows);
  return state;
}

Planner::State Planner::joinAlone(State state, const Node& part) {
  State other = alone(part);
  if (state.is_unit) return other;
  return hashJoin(std::move(state), std::move(other));
}

Planner::State Planner::hashJoin(State state, State other) {
  // The smaller side goes into the table, where the sides may be swapped.
  if (!state.is_input && other.rows > state.rows * 2) std::swap(state, other);
  const SlotSet shared = state.possible & other.possible;
  const SlotSet keys = shared & state.certain & other.certain;
  const bool connected = !shared.empty();
  const double rows = connected ? std::max(state.rows, other.rows) : state.rows * other.rows;
  state.top = makeHashJoin(std::move(state.top), std::move(other.top), keys.list(), (shared - keys).list());
  state.certain.add(other.certain);
  state.possible.add(other.possible);
  state.is_unit = false;
  setRows(state, rows);
  return state;
}

Planner::State Planner::leftJoin(State state, const Node& node) {
  const Node& optional = *node.children[1];
  const double rows = state.rows * 1.2;
  Pipeline inner = pipeline(state, false, [&](State from) { return joinNode(std::move(from), optional, node.conditions); });
  state.top = makeLeftJoin(std::move(state.top), std::move(inner));
  state.top->at = node.at;
  state.possible.add(optional.possible);
  state.sorted_by = kNoSlot;
  state.is_unit = false;
  setRows(state, rows);
  return state;
}

Planner::State Planner::minus(State state, const Node& node) {
  const Node& removed = *node.children[1];
  SlotSet shared = node.children[0]->possible & removed.possible;
  const Slot ignored = node.minus_ignores;
  SlotSet counted = shared;
  if (ignored != kNoSlot) counted.remove(ignored);
  if (counted.empty()) return state;
  State other = alone(removed);
  // Keys bind on both sides in every row; the graph's own variable may be a key but does not count as shared.
  SlotSet keys = shared & node.children[0]->certain & other.certain;
  if (ignored != kNoSlot && (counted & keys).empty()) keys.remove(ignored);
  state.top = makeMinus(std::move(state.top), std::move(other.top), keys.list(), (shared - keys).list(), ignored);
  state.top->at = node.at;
  setRows(state, state.rows);
  return state;
}

Planner::State Planner::extend(State state, const std::vector<const Node*>& nodes) {
  std::vector<std::pair<Slot, Expr>> columns;
  std::vector<const Expr*> expressions;
  for (const Node* node : nodes) columns.emplace_back(node->slot, *node->expression);
  for (const auto& [slot, expression] : columns) expressions.push_back(&expression);
  auto exists = planExists(state, expressions);
  const double rows = state.rows;
  state.top = makeExtend(std::move(state.top), std::move(columns), std::move(exists));
  for (const Node* node : nodes) {
    state.possible.add(node->slot);
    if (node->certain.has(node->slot)) state.certain.add(node->slot);
  }
  state.is_unit = false;
  setRows(state, rows);
  return state;
}

Planner::State Planner::alone(const Node& node) {
  switch (node.kind) {
    case Node::Kind::Group:
    case Node::Kind::OrderBy:
    case Node::Kind::Project:
    case Node::Kind::Distinct:
    case Node::Kind::Slice: return select(node, std::nullopt, {});
    case Node::Kind::Values: {
      State state;
      state.top = makeValues(node.slots, node.rows);
      state.certain = node.certain;
      state.possible = node.possible;
      state.is_unit = false;
      setRows(state, static_cast<double>(node.rows.size()));
      if (parameters_.empty()) return state;
      return hashJoin(unit(), std::move(state));
    }
    case Node::Kind::GraphLoop: {
      parameters_.push_back(node.graph.slot);
      State state = alone(*node.children[0]);
      parameters_.pop_back();
      state.top = makeGraphLoop(std::move(state.top), node.graph.slot);
      state.certain.add(node.graph.slot);
      state.possible.add(node.graph.slot);
      state.sorted_by = kNoSlot;
      return state;
    }
    default: return joinNode(unit(), node, {});
  }
}

Planner::State Planner::select(const Node& node, std::optional<std::uint64_t> most_rows, const std::vector<Slot>& columns) {
  const Node& child = *node.children[0];
  const auto below = [&](std::optional<std::uint64_t> rows, const std::vector<Slot>& slots) {
    const bool modifier = child.kind == Node::Kind::OrderBy || child.kind == Node::Kind::Project ||
                          child.kind == Node::Kind::Distinct || child.kind == Node::Kind::Slice;
    return modifier ? select(child, rows, slots) : alone(child);
  };
  if (node.kind == Node::Kind::Slice) {
    std::optional<std::uint64_t> wanted;
    if (node.limit && child.kind != Node::Kind::Distinct) wanted = node.offset + *node.limit;
    State state = below(wanted, columns);
    const double rows = node.limit ? std::min(state.rows, static_cast<double>(*node.limit)) : state.rows;
    state.top = makeSlice(std::move(state.top), node.offset, node.limit);
    setRows(state, rows);
    return state;
  }
  if (node.kind == Node::Kind::Distinct) {
    State state = below(std::nullopt, node.slots);
    std::vector<Slot> slots = node.slots;
    for (const Slot slot : parameters_) slots.push_back(slot);
    state.top = makeDistinct(std::move(state.top), mergedSlots(slots, {}));
    setRows(state, state.rows);
    return state;
  }
  if (node.kind == Node::Kind::Project) {
    State state = below(most_rows, node.slots);
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
  if (node.kind == Node::Kind::OrderBy) {
    State state = alone(child);
    std::vector<const Expr*> expressions;
    for (const SortKey& key : node.sort_keys) expressions.push_back(&key.expression);
    auto exists = planExists(state, expressions);
    const double rows = most_rows ? std::min(state.rows, static_cast<double>(*most_rows)) : state.rows;
    state.top = makeOrder(std::move(state.top), node.sort_keys, columns, most_rows, std::move(exists));
    setRows(state, rows);
    return state;
  }
  // Group.
  State state = alone(child);
  std::vector<const Expr*> expressions;
  for (const AggregateSpec& aggregate : node.aggregates) {
    if (aggregate.argument) expressions.push_back(&*aggregate.argument);
  }
  auto exists = planExists(state, expressions);
  State grouped;
  std::vector<Slot> keys = mergedSlots(node.slots, {});
  grouped.top = makeGroup(std::move(state.top), keys, node.aggregates, node.grouped_by_keys, parameters_, std::move(exists));
  grouped.certain = node.certain;
  grouped.possible = node.possible;
  for (const Slot slot : parameters_) {
    grouped.certain.add(slot);
    grouped.possible.add(slot);
  }
  grouped.is_unit = false;
  setRows(grouped, node.grouped_by_keys ? std::max(1.0, std::sqrt(state.rows) * 4) : 1);
  return grouped;
}

}  // namespace cluxel::sparql
