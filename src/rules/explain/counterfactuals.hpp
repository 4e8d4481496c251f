// SPDX-License-Identifier: Apache-2.0
// Counterfactuals: the smallest change of measured values that flips a condition.
#pragma once

#include <optional>
#include <vector>

#include "rules/explain/explain.hpp"

namespace cluxel::rules {

/// Sum of margins relative to their thresholds, which makes metres and degrees comparable.
double costOf(const std::vector<NeededChange>& changes);

/// The cheapest set of changes that flips the condition. Its elementary tests stand in `path` from `first_step` on, in
/// evaluation order. Absent when a test without a measured value, or a query that was skipped, would have to flip as
/// well.
std::optional<std::vector<NeededChange>> counterfactualChanges(const Condition& condition,
                                                               const std::vector<DecisionStep>& path,
                                                               std::size_t first_step);

}  // namespace cluxel::rules
