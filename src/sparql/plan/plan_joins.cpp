// SPDX-License-Identifier: Apache-2.0
// Plans single steps: the join algorithm of each pattern, OPTIONAL and MINUS.
#include <algorithm>
#include <cmath>

#include "sparql/exec/spatial/subject_column.hpp"
#include "sparql/plan/pattern_access.hpp"
#include "sparql/plan/planner.hpp"

namespace cluxel::sparql {
namespace {

// Cost constants in nanoseconds, measured on this store: index lookup by ascending and by random ids, entry of an index
// scan, hash table insert and probe.
constexpr double kAscendingLookup = 120, kScatteredLookup = 350, kScannedEntry = 4, kHashBuild = 35, kHashProbe = 25,
                 kMergedRow = 8, kColumnMade = 25, kColumnLookup = 25;  // building a column, per quad of the predicate
/// The assumed number of input rows per row requested by a LIMIT.
constexpr double kRowsPerNeededRow = 64;

BoundMask constantsOf(const TripleNode& pattern, const Dataset& dataset) {
  BoundMask mask = 0;
  if (!pattern.subject.isSlot()) mask |= 1;
  if (!pattern.predicate.isSlot()) mask |= 2;
  if (!pattern.object.isSlot()) mask |= 4;
  const bool one_default =
      pattern.graph.kind == GraphPlace::Kind::Default && dataset.default_graph.kind == GraphFilter::Kind::One;
  if (pattern.graph.kind == GraphPlace::Kind::Constant || one_default) mask |= 8;
  return mask;
}

/// The slot by which a scan in this order is sorted.
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

/// Numbers are in an index of their own, which sorts by subject.
OrderChoice Planner::scanOf(const TripleNode& pattern) const {
  const OrderChoice choice = chooseOrder(constantsOf(pattern, dataset_));
  const bool is_of_predicate = choice.order == rdf::QuadOrder::Posg && choice.prefix == 1;
  if (!is_of_predicate || pattern.predicate.constant >= kFirstComputed) return choice;
  return reader_.hasOnlyNumbers(pattern.predicate.constant) ? OrderChoice{rdf::QuadOrder::Psog, 1} : choice;
}

/// The slot by which a scan of the pattern is sorted.
Slot Planner::scannedBy(const TripleNode& pattern) const {
  return sortedBy(pattern, scanOf(pattern));
}

Planner::State Planner::joinPart(State state, const Node& part, double needed_rows) {
  switch (part.kind) {
    case Node::Kind::Triple:
      return joinTriple(std::move(state), part, needed_rows);
    case Node::Kind::Union:
      return joinUnion(std::move(state), part);
    case Node::Kind::GraphNames: {
      const double rows = rowsAfter(state, part);
      OperatorPtr top = makeGraphNames(std::move(state.top), part.graph);
      return joined(std::move(state), std::move(top), part, rows);
    }
    default:
      return joinAlone(std::move(state), part);
  }
}

/// The planner state after `top` has joined `part`.
Planner::State Planner::joined(State state, OperatorPtr top, const Node& part, double rows) {
  state.top = std::move(top);
  state.top->at = part.at;
  state.certain.add(part.certain);
  state.possible.add(part.possible);
  state.is_unit = false;
  setRows(state, rows);
  return state;
}

Planner::State Planner::joinTriple(State state, const Node& part, double needed_rows) {
  const TripleNode& pattern = part.triple;
  const double rows = rowsAfter(state, part);
  const auto finish = [&](OperatorPtr top) { return joined(std::move(state), std::move(top), part, rows); };
  if (isImpossible(pattern, dataset_)) {
    const auto slots = mergedSlots(state.top->slots(), part.possible.list());
    return finish(std::make_unique<NothingOperator>(std::move(state.top), pattern, slots));
  }
  if (pattern.path) {
    state.sorted_by = kNoSlot;
    return finish(makePathJoin(std::move(state.top), pattern));
  }
  const OrderChoice scan = scanOf(pattern);
  if (state.is_unit) {
    state.sorted_by = sortedBy(pattern, scan);
    return finish(makeScan(pattern, scan.order));
  }
  return finish(joinOperator(state, part, scan, needed_rows));
}

/// Chooses the cheapest of merge join, hash join and index nested loop join.
OperatorPtr Planner::joinOperator(State& state, const Node& part, const OrderChoice& scan, double needed_rows) {
  const TripleNode& pattern = part.triple;
  const std::vector<Slot> keys = (part.possible & state.certain).list();
  const double own = cardinality_.matches(pattern);
  const bool ascending = state.sorted_by != kNoSlot && part.possible.has(state.sorted_by);
  // With a LIMIT the lookups end early, whereas a hash table is built completely. Not every row has a match.
  const double looked_up = std::min(state.rows, needed_rows * kRowsPerNeededRow);
  const double index_cost = looked_up * (ascending ? kAscendingLookup : kScatteredLookup);
  const double column_cost = columnCost(state, pattern, looked_up);
  const double lookup_cost = std::min(index_cost, column_cost);
  const double hash_cost = own * (kScannedEntry + kHashBuild) + looked_up * kHashProbe;
  const std::vector<Slot> shared = (part.possible & state.possible).list();
  const double share = state.rows > 0 ? looked_up / state.rows : 1;
  const double merge_cost = share * (own * kScannedEntry + state.rows * kMergedRow);
  const bool can_merge = ascending && sortedBy(pattern, scan) == state.sorted_by && shared == keys && !state.is_input;
  if (can_merge && merge_cost < std::min(lookup_cost, hash_cost)) {
    auto other = makeScan(pattern, scan.order);
    other->estimated_rows = own;
    const Slot slot = state.sorted_by;
    return makeMergeJoin(std::move(state.top), std::move(other), slot);
  }
  if (!keys.empty() && state.outer.empty() && hash_cost < lookup_cost) {
    std::vector<Slot> compared;
    std::set_difference(shared.begin(), shared.end(), keys.begin(), keys.end(), std::back_inserter(compared));
    auto build = makeScan(pattern, scan.order);
    build->estimated_rows = own;
    return makeHashJoin(std::move(state.top), std::move(build), keys, compared);
  }
  return makeQuadJoin(std::move(state.top), pattern, column_cost < index_cost);
}

/// The cost of building a column and looking up in it; kAllRows when the pattern cannot use one. Existing columns are
/// not considered, so that a plan is independent of earlier queries.
double Planner::columnCost(const State& state, const TripleNode& pattern, double lookups) {
  const bool fits = pattern.subject.isSlot() && state.certain.has(pattern.subject.slot) &&
                    !pattern.predicate.isSlot() && pattern.graph.kind == GraphPlace::Kind::Default &&
                    hasColumns(dataset_.default_graph);
  if (!fits) return kAllRows;
  const double quads =
      pattern.object.isSlot() ? cardinality_.quadsOf(pattern.predicate.constant) : cardinality_.matches(pattern);
  return quads * kColumnMade + lookups * kColumnLookup;
}

Planner::State Planner::joinUnion(State state, const Node& part) {
  const double own = cardinality_.rows(part);
  // A part planned on its own starts from the parameters too.
  SlotSet joined_so_far = state.possible;
  for (const Slot slot : parameters_) joined_so_far.remove(slot);
  const bool connected = !joined_so_far.empty() && state.certain.intersects(part.certain);
  // Branches that are small compared to the input are evaluated once and hashed.
  if (!state.is_unit && state.outer.empty() && connected &&
      own * (kScannedEntry + kHashBuild) < state.rows * kAscendingLookup) {
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
    branches.push_back(
        pipeline(state, state.outer, [&](State inner) { return joinNode(std::move(inner), *branch, {}); }));
  }
  state.sorted_by = kNoSlot;
  OperatorPtr top = makeUnion(std::move(state.top), std::move(branches));
  return joined(std::move(state), std::move(top), part, rows);
}

Planner::State Planner::joinAlone(State state, const Node& part) {
  const SlotSet seen = seenFromOutside(state, part);
  if (!seen.empty()) return joinCorrelated(std::move(state), part, seen);
  State other = alone(part);
  if (state.is_unit) return other;
  return hashJoin(std::move(state), std::move(other));
}

Planner::State Planner::hashJoin(State state, State other) {
  // The smaller side becomes the build side, if the sides may be swapped.
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
  Pipeline inner =
      pipeline(state, state.outer, [&](State from) { return joinNode(std::move(from), optional, node.conditions); });
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
  const SlotSet seen = seenFromOutside(state, removed);
  if (!seen.empty()) return minusCorrelated(std::move(state), node, seen, shared.list());
  State other = alone(removed);
  // Keys are bound in every row of both sides. The graph variable may be a key, but does not count as a shared
  // variable.
  SlotSet keys = shared & node.children[0]->certain & other.certain;
  if (ignored != kNoSlot && (counted & keys).empty()) keys.remove(ignored);
  state.top = makeMinus(std::move(state.top), std::move(other.top), keys.list(), (shared - keys).list(), ignored);
  state.top->at = node.at;
  setRows(state, state.rows);
  return state;
}

}  // namespace cluxel::sparql
