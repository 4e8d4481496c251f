// SPDX-License-Identifier: Apache-2.0
// Plans EXISTS: the outer solution is substituted into every part of the pattern (SPARQL 1.1 section 18.6). Patterns
// receive it as input rows, independent parts such as sub-selects as parameters.
#include <algorithm>

#include "sparql/plan/planner.hpp"

namespace cluxel::sparql {
namespace {

/// True when evaluating the node independently and joining gives the same result as substitution.
bool isPlain(const Node& node) {
  switch (node.kind) {
    case Node::Kind::Unit:
    case Node::Kind::Nothing:
    case Node::Kind::Triple:
    case Node::Kind::GraphNames:
    case Node::Kind::Values:
      return true;
    case Node::Kind::Join:
    case Node::Kind::Union:
      return std::all_of(node.children.begin(), node.children.end(),
                         [](const NodePtr& child) { return isPlain(*child); });
    default:
      return false;
  }
}

}  // namespace

SlotSet Planner::seenFromOutside(const State& state, const Node& part) const {
  if (state.outer.empty() || isPlain(part)) return {};
  SlotSet seen = part.mentioned() & state.outer;
  for (const Slot slot : parameters_) seen.remove(slot);
  return seen;
}

OperatorPtr Planner::correlatedBody(const State& state, const Node& part, const SlotSet& seen) {
  const std::vector<Slot> parameters = parameters_;
  const SlotSet unsure = unsure_parameters_;
  for (const Slot slot : seen.list()) {
    parameters_.push_back(slot);
    if (!state.certain.has(slot)) unsure_parameters_.add(slot);
  }
  OperatorPtr body = alone(part).top;
  parameters_ = parameters;
  unsure_parameters_ = unsure;
  return body;
}

Planner::State Planner::joinCorrelated(State state, const Node& part, const SlotSet& seen) {
  const double rows = rowsAfter(state, part);
  OperatorPtr body = correlatedBody(state, part, seen);
  state.sorted_by = kNoSlot;
  OperatorPtr top = makeCorrelatedJoin(std::move(state.top), std::move(body), seen.list());
  return joined(std::move(state), std::move(top), part, rows);
}

Planner::State Planner::minusCorrelated(State state, const Node& node, const SlotSet& seen,
                                        const std::vector<Slot>& shared) {
  OperatorPtr body = correlatedBody(state, *node.children[1], seen);
  state.top = makeCorrelatedMinus(std::move(state.top), std::move(body), seen.list(), shared, node.minus_ignores);
  state.top->at = node.at;
  setRows(state, state.rows);
  return state;
}

}  // namespace cluxel::sparql
