// SPDX-License-Identifier: Apache-2.0
// From the algebra to operators: the order of joins, the kind of each, and where filters go.
#pragma once

#include <functional>
#include <vector>

#include "sparql/cardinality.hpp"
#include "sparql/operators.hpp"

namespace cluxel::sparql {

class Planner {
 public:
  Planner(AlgebraQuery& query, const QuadReader& reader, const Dataset& dataset)
      : query_(query), reader_(reader), dataset_(dataset), cardinality_(reader, dataset), parameters_(query.parameters) {}

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
    bool is_unit = true;        ///< one solution without bindings: joining it changes nothing
    bool is_input = false;      ///< rows come from outside, batch by batch
    bool substituted = false;   ///< within EXISTS: bindings from outside hold everywhere
  };
  /// A step that must wait until all parts are joined.
  struct Postponed {
    enum class Kind { LeftJoin, Minus, Extend } kind;
    const Node* node;
  };
  /// What a group consists of once nested joins, filters and optionals are taken apart.
  struct Parts {
    std::vector<const Node*> joined;
    std::vector<Postponed> postponed;
    std::vector<Expr> filters;
    std::vector<NodePtr> made;   ///< keeps nodes that planning made
  };

  State unit();
  State joinNode(State state, const Node& node, const std::vector<Expr>& extra_filters);
  State joinParts(State state, Parts& parts);
  State joinPart(State state, const Node& part);
  State joinTriple(State state, const Node& part);
  State joinUnion(State state, const Node& part);
  State joinAlone(State state, const Node& part);
  State hashJoin(State state, State other);
  State applyPostponed(State state, Parts& parts, std::vector<bool>& used);
  State leftJoin(State state, const Node& node);
  State minus(State state, const Node& node);
  State extend(State state, const std::vector<const Node*>& nodes);
  State applyFilters(State state, Parts& parts, const SlotSet& still_to_come, std::vector<bool>& used);
  State filter(State state, std::vector<Expr> conditions);
  State alone(const Node& node);
  State select(const Node& node, std::optional<std::uint64_t> most_rows, const std::vector<Slot>& columns);

  void takeApart(const Node& node, const SlotSet& rest, Parts& parts);
  void takeFilters(const Node& filter, const SlotSet& rest, Parts& parts);
  bool bindsByFilter(const Expr& condition, const Node& child, Parts& parts);
  std::size_t choosePart(const State& state, const std::vector<const Node*>& parts);
  double rowsAfter(const State& state, const Node& part);
  Pipeline pipeline(const State& state, bool substituted, const std::function<State(State)>& body);
  std::vector<ExistsPlan> planExists(const State& state, const std::vector<const Expr*>& expressions);
  Slot freshSlot(const char* name);
  void setRows(State& state, double rows);

  AlgebraQuery& query_;
  const QuadReader& reader_;
  const Dataset& dataset_;
  Cardinality cardinality_;
  std::vector<Slot> parameters_;
};

}  // namespace cluxel::sparql
