// SPDX-License-Identifier: Apache-2.0
// Evaluates conditions for bound candidates and records the measured values.
#pragma once

#include <optional>
#include <vector>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// True when `value` passes the comparison with the condition's thresholds.
bool compare(const Condition& condition, double value, double threshold);

class ConditionEvaluator {
 public:
  ConditionEvaluator(const ReasoningState& state, const Rule& rule, const Bindings& bindings)
      : state_(state), rule_(rule), bindings_(bindings) {}

  /// Evaluates, and appends one step per elementary test to `steps` when given.
  bool holds(const Condition& condition, std::vector<DecisionStep>* steps = nullptr);
  bool allHold(const std::vector<Condition>& conditions);
  /// What a line of evidence measures; absent when a slice is empty. Distances are measured up to `reach`, and are
  /// `reach` beyond.
  std::optional<double> measure(const Condition& condition, double reach);
  /// "m", "rad" and the like.
  static std::string unitOf(const Condition& condition);
  /// The object found by the last relation or measure that passed.
  std::optional<OwnerIndex> related() const { return related_; }

 private:
  bool holdsElementary(const Condition& condition, DecisionStep& step);
  bool holdsAttribute(const Condition& condition, DecisionStep& step);
  /// Absent when the candidate has no cluxel in the slice.
  std::optional<double> measured(const std::string& of, const std::optional<SliceSpec>& slice,
                                 perception::Attribute attribute) const;
  bool holdsPair(const Condition& condition, DecisionStep& step);
  bool holdsRelation(const Condition& condition, DecisionStep& step);
  bool holdsAsk(const Condition& condition);
  bool fits(FragmentIndex fragment, const Target& target) const;
  std::optional<std::pair<FragmentIndex, double>> nearestTarget(const Condition& condition, double limit_m);
  void remember(FragmentIndex fragment, const Target& target);

  const ReasoningState& state_;
  const Rule& rule_;
  const Bindings& bindings_;
  std::optional<OwnerIndex> related_;
};

}  // namespace cluxel::rules
