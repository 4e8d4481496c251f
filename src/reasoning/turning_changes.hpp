// SPDX-License-Identifier: Apache-2.0
// What has to change for a condition to come out otherwise.
#pragma once

#include <optional>
#include <vector>

#include "cluxel/reasoning/explain.hpp"

namespace cluxel {

/// How large changes are beside their thresholds, added up: to compare metres with degrees.
double costOf(const std::vector<NeededChange>& changes);

/// The least set of changes that turns the condition, whose elementary tests stand in `path` from `first_step` on, in
/// the order of evaluation. Absent when tests without a measure, or queries that were not asked, would have to turn
/// too.
std::optional<std::vector<NeededChange>> changesThatTurn(const Condition& condition,
                                                         const std::vector<DecisionStep>& path, std::size_t first_step);

}  // namespace cluxel
