// SPDX-License-Identifier: Apache-2.0
// Evaluates conditions against bound things, and says what was measured.
#pragma once

#include <optional>
#include <vector>

#include "reasoning/reasoning_state.hpp"

namespace cluxel {

/// True when `value` passes the comparison with the condition's thresholds.
bool compare(const Condition& condition, double value, double threshold);

class ConditionEvaluator {
 public:
  ConditionEvaluator(const ReasoningState& state, const Rule& rule, const Bindings& bindings)
      : state_(state), rule_(rule), bindings_(bindings) {}

  /// Evaluates, and appends one step per elementary test to `steps` when given.
  bool holds(const Condition& condition, std::vector<DecisionStep>* steps = nullptr);
  bool allHold(const std::vector<Condition>& conditions);
  /// The object that the last passed relation or measure to an object met.
  std::optional<OwnerIndex> related() const { return related_; }

 private:
  bool holdsElementary(const Condition& condition, DecisionStep& step);
  bool holdsAttribute(const Condition& condition, DecisionStep& step);
  /// Absent when nothing of the thing is in the slice.
  std::optional<double> measured(const std::string& of, const std::optional<SliceSpec>& slice,
                                 Attribute attribute) const;
  bool holdsPair(const Condition& condition, DecisionStep& step);
  bool holdsRelation(const Condition& condition, DecisionStep& step);
  bool holdsAsk(const Condition& condition);
  bool fits(PieceIndex piece, const Target& target) const;
  std::optional<std::pair<PieceIndex, double>> nearestTarget(const Condition& condition, double limit_m);
  void remember(PieceIndex piece, const Target& target);

  const ReasoningState& state_;
  const Rule& rule_;
  const Bindings& bindings_;
  std::optional<OwnerIndex> related_;
};

}  // namespace cluxel
