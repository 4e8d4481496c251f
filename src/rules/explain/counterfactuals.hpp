// SPDX-License-Identifier: Apache-2.0
// Counterfactuals: the smallest change of measured values that flips a condition.
#pragma once

#include <optional>
#include <vector>

#include "rules/language/rule_condition.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::rules {

/// Sum of margins relative to their thresholds, which makes metres and degrees comparable.
double costOf(const std::vector<NeededChange>& changes);

/// An elementary test that a change of its measured value turns.
struct TurnedTest {
  const Condition* test = nullptr;  ///< of the rule
  double measured = 0, value = 0;   ///< what is measured, and the nearest value on the other side of the threshold [SI]
  NeededChange change;
};

/// The cheapest set of tests whose turn flips the condition. Its elementary tests stand in `path` from `first_step` on,
/// in evaluation order. Absent when a test without a measured value, or a query that was skipped, would have to flip as
/// well.
std::optional<std::vector<TurnedTest>> leastTurns(const Condition& condition, const std::vector<DecisionStep>& path,
                                                  std::size_t first_step);
/// The changes of leastTurns().
std::optional<std::vector<NeededChange>> counterfactualChanges(const Condition& condition,
                                                               const std::vector<DecisionStep>& path,
                                                               std::size_t first_step);

}  // namespace cluxel::rules
