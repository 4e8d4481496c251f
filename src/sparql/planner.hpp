// SPDX-License-Identifier: Apache-2.0
// From the algebra to operators: the order of joins, the kind of each, and where filters go.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "sparql/cardinality.hpp"
#include "sparql/operators.hpp"
#include "sparql/pattern_access.hpp"

namespace cluxel::sparql {

class Planner {
 public:
  Planner(AlgebraQuery& query, const QueryTerms& terms, const Dataset& dataset)
      : query_(query),
        terms_(terms),
        reader_(terms.reader()),
        dataset_(dataset),
        cardinality_(terms.reader(), dataset),
        parameters_(query.parameters) {}

  /// The whole query's plan.
  OperatorPtr plan();
  /// The plan of one node by itself.
  OperatorPtr planAlone(const Node& node);

 private:
  /// A plan under construction: it gives the solutions joined so far.
  struct State {
    OperatorPtr top;
    SlotSet certain, possible;
    double rows = 1;
    Slot sorted_by = kNoSlot;
    bool is_unit = true;    ///< one solution without bindings: joining it changes nothing
    bool is_input = false;  ///< rows come from outside, batch by batch
    SlotSet outer;          ///< within EXISTS: slots of the solution from outside, which hold everywhere
  };
  /// A step that must wait until all parts are joined.
  struct Postponed {
    enum class Kind { LeftJoin, Minus, Extend } kind;
    const Node* node;
  };
  static constexpr double kAllRows = 1e300;
  /// What a group consists of once nested joins, filters and optionals are taken apart.
  struct Parts {
    std::vector<const Node*> joined;
    std::vector<Postponed> postponed;
    std::vector<Expr> filters;
    std::vector<NodePtr> made;      ///< keeps nodes that planning made
    SlotSet constant;               ///< have one value in all parts of a solution
    double wanted_rows = kAllRows;  ///< of the first rows of the first part, how many will be asked for
  };

  State unit();
  State joinNode(State state, const Node& node, const std::vector<Expr>& extra_filters);
  State joinParts(State state, Parts& parts);
  State joinPart(State state, const Node& part, double wanted_rows);
  State joinTriple(State state, const Node& part, double wanted_rows);
  OperatorPtr joinOperator(State& state, const Node& part, const OrderChoice& scan, double wanted_rows);
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
  State select(const Node& node, std::optional<std::uint64_t> most_rows, const std::vector<Slot>& columns);
  State belowModifier(const Node& child, std::optional<std::uint64_t> most_rows, const std::vector<Slot>& columns);
  State slice(const Node& node, const std::vector<Slot>& columns);
  State distinct(const Node& node);
  State project(const Node& node, std::optional<std::uint64_t> most_rows);
  State order(const Node& node, std::optional<std::uint64_t> most_rows, const std::vector<Slot>& columns);
  State group(const Node& node);
  State graphLoop(const Node& node);
  State values(const Node& node);

  void takeApart(const Node& node, const SlotSet& rest, const SlotSet& after, Parts& parts);
  void takeFilters(const Node& filter, const SlotSet& rest, const SlotSet& after, Parts& parts);
  bool bindsByFilter(const Expr& condition, const Node& child, Parts& parts);
  void searchBySpace(const Expr& condition, const Node& child, Parts& parts);
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
  const QuadReader& reader_;
  const Dataset& dataset_;
  Cardinality cardinality_;
  std::vector<Slot> parameters_;
  double wanted_rows_ = kAllRows;  ///< by a LIMIT around the next group
  SlotSet unsure_parameters_;      ///< those that may be unbound
};

}  // namespace cluxel::sparql
