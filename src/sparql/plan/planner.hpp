// SPDX-License-Identifier: Apache-2.0
// The query planner: join order, join algorithms and filter placement.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <vector>

#include "sparql/exec/operators/operators.hpp"
#include "sparql/exec/spatial/nearest_others.hpp"
#include "sparql/plan/cardinality.hpp"
#include "sparql/plan/pattern_access.hpp"
#include "sparql/plan/range_finder.hpp"

namespace cluxel::sparql {

class Planner {
 public:
  /// `spatial_plans`: see QueryOptions.
  Planner(AlgebraQuery& query, const QueryTerms& terms, const Dataset& dataset, bool spatial_plans = true)
      : query_(query),
        terms_(terms),
        reader_(terms.reader()),
        dataset_(dataset),
        cardinality_(terms.reader(), dataset),
        parameters_(query.parameters),
        spatial_plans_(spatial_plans) {}

  /// Plans the whole query.
  OperatorPtr plan();
  /// Plans one node on its own.
  OperatorPtr planAlone(const Node& node);

 private:
  /// A partial plan that produces the solutions joined so far.
  struct State {
    OperatorPtr top;
    SlotSet certain, possible;
    double rows = 1;
    Slot sorted_by = kNoSlot;
    bool is_unit = true;    ///< one solution without bindings: joining it changes nothing
    bool is_input = false;  ///< input rows arrive in batches from an outer operator
    SlotSet outer;          ///< in EXISTS: slots of the outer solution, constant throughout
  };
  /// A step that is applied after all parts are joined.
  struct Postponed {
    enum class Kind { LeftJoin, Minus, Extend } kind;
    const Node* node;
  };
  static constexpr double kAllRows = 1e300;
  /// Only the least distance counts among the rows that agree in `keys`.
  struct Closest {
    Expr distance;
    SlotSet keys;
  };
  /// A flattened group.
  struct Parts {
    std::vector<const Node*> joined;
    std::vector<Postponed> postponed;
    std::vector<Expr> filters;
    std::vector<NodePtr> made;       ///< owns nodes created by the planner
    SlotSet constant;                ///< slots with the same value in all parts
    std::optional<Closest> closest;  ///< set when only the nearest rows are wanted
    double needed_rows = kAllRows;   ///< number of rows of the first part that will be consumed
  };

  State unit();
  State joinNode(State state, const Node& node, const std::vector<Expr>& extra_filters);
  State joinParts(State state, Parts& parts);
  State joinPart(State state, const Node& part, double needed_rows);
  State joinTriple(State state, const Node& part, double needed_rows);
  OperatorPtr joinOperator(State& state, const Node& part, const OrderChoice& scan, double needed_rows);
  double columnCost(const State& state, const TripleNode& pattern, double lookups);
  static State joined(State state, OperatorPtr top, const Node& part, double rows);
  State joinUnion(State state, const Node& part);
  State joinAlone(State state, const Node& part);
  State hashJoin(State state, State other);
  State joinCorrelated(State state, const Node& part, const SlotSet& seen);
  State minusCorrelated(State state, const Node& node, const SlotSet& seen, const std::vector<Slot>& shared);
  OperatorPtr correlatedBody(const State& state, const Node& part, const SlotSet& seen);
  SlotSet seenFromOutside(const State& state, const Node& part) const;
  State applyPostponed(State state, Parts& parts, std::vector<bool>& used);
  State leftJoin(State state, const Node& node);
  State minus(State state, const Node& node);
  static std::vector<const Node*> neighbouringBinds(std::span<const Postponed> steps);
  State extend(State state, const std::vector<const Node*>& nodes);
  State applyFilters(State state, Parts& parts, const SlotSet& still_to_come, std::vector<bool>& used);
  State filter(State state, std::vector<Expr> conditions);
  State filterBeforeBinds(State state, const std::vector<const Node*>& binds, Parts& parts,
                          std::span<const Postponed> later, std::vector<bool>& used);
  State alone(const Node& node);
  State select(const Node& node, std::optional<std::uint64_t> max_rows, const std::vector<Slot>& columns);
  State belowModifier(const Node& child, std::optional<std::uint64_t> max_rows, const std::vector<Slot>& columns);
  State slice(const Node& node, const std::vector<Slot>& columns);
  State distinct(const Node& node);
  State project(const Node& node, std::optional<std::uint64_t> max_rows);
  State order(const Node& node, std::optional<std::uint64_t> max_rows, const std::vector<Slot>& columns);
  std::vector<const Node*> lateBinds(const Node*& child, std::vector<SortKey>& keys) const;
  static Expr tieOf(Slot slot, const std::vector<const Node*>& late);
  std::optional<State> nearestFirst(const Node& body, const SortKey& key, std::uint64_t max_rows);
  std::optional<State> nearestFirst(const Node& body, Slot geometry, const Expr& place, std::uint64_t max_rows);
  State nearestSource(State around, Parts& parts, NearestScan scan, double rows);
  State group(const Node& node);
  void noteEnough(const Node& group, const std::vector<Expr>& having);
  State graphLoop(const Node& node);
  State values(const Node& node);

  void takeApart(const Node& node, const SlotSet& rest, const SlotSet& after, Parts& parts);
  void takeFilters(const Node& filter, const SlotSet& rest, const SlotSet& after, Parts& parts);
  bool bindsByFilter(const Expr& condition, const Node& child, Parts& parts);
  using Waiting = std::vector<const Node*>;
  /// The variables of the two sides of a range join.
  struct RangeSides {
    SlotSet other;           ///< bound in every row of the component only
    SlotSet given;           ///< of the rows so far: what tests of the component may read
    SlotSet given_by_other;  ///< of the component: what tests of the rows so far may read
    SlotSet outside;         ///< all that is visible around an EXISTS
    BoundExpressions binds;
  };
  /// A component of the waiting parts, and what ties it to the rows so far.
  struct RangeJoin {
    State other;
    std::vector<RangeTest> tests;
    std::optional<NearestTest> nearest;
    bool is_reversed = false;  ///< the tests limit the rows so far by the component
    std::vector<bool> used;    ///< the filters, after those within the component
  };
  std::optional<State> joinByRange(State& state, Waiting& waiting, const Parts& parts, std::vector<bool>& used);
  bool blowsUp(const State& state, const Waiting& waiting);
  std::vector<Waiting> componentsOf(const State& state, const Waiting& waiting) const;
  std::optional<RangeJoin> rangeJoinWith(const State& state, const Waiting& component, const Waiting& waiting,
                                         const Parts& parts, const std::vector<bool>& used);
  RangeSides sidesOf(const State& state, const Waiting& component, const Waiting& waiting, const Parts& parts) const;
  void addTests(const State& state, const RangeSides& sides, const Parts& parts, RangeJoin& join);
  std::optional<NearestTest> nearestOf(const Expr& condition, const SlotSet& probe, const SlotSet& build,
                                       const SlotSet& outside);
  static std::optional<Closest> closestOf(const Node& group);
  void addClosest(const State& state, const Waiting& waiting, const Parts& parts, const SlotSet& build,
                  const Expr& distance, RangeJoin& join);
  Parts taken(const Waiting& nodes, const Parts& parts, const SlotSet& slots) const;
  State finishRange(State state, RangeJoin join);
  std::optional<State> joinByIndex(State& state, const RangeJoin& join, const Waiting& component);
  void searchBySpace(const Expr& condition, const Node& child, Parts& parts);
  OrderChoice scanOf(const TripleNode& pattern) const;
  Slot scannedBy(const TripleNode& pattern) const;
  double disorder(const Node& part, const std::vector<const Node*>& parts) const;
  std::size_t choosePart(const State& state, const std::vector<const Node*>& parts);
  double rowsAfter(const State& state, const Node& part);
  Pipeline pipeline(const State& state, const SlotSet& outer, const std::function<State(State)>& body);
  std::vector<ExistsPlan> planExists(const State& state, const std::vector<const Expr*>& expressions);
  Slot freshSlot(const char* name);
  static void setRows(State& state, double rows);

  AlgebraQuery& query_;
  const QueryTerms& terms_;
  const rdf::QuadReader& reader_;
  const Dataset& dataset_;
  Cardinality cardinality_;
  std::vector<Slot> parameters_;
  double needed_rows_ = kAllRows;  ///< from a LIMIT around the next group
  SlotSet unsure_parameters_;      ///< parameters that may be unbound
  bool spatial_plans_;
  std::optional<Closest> closest_;            ///< from a MIN around the next group
  std::map<const Node*, EnoughRows> enough_;  ///< of groups whose counts HAVING bounds
  std::vector<NodePtr> made_;                 ///< nodes that estimates are kept for
};

}  // namespace cluxel::sparql
