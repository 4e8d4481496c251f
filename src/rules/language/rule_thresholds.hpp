// SPDX-License-Identifier: Apache-2.0
// The thresholds of a rule set that a run compares with measured numbers and does nothing else with. When only these
// change, the run before tells what may turn out otherwise; see ThresholdMargins.
#pragma once

#include "rules/language/rule_set.hpp"

namespace cluxel::rules {

/// True for a test of a measured number against a constant or a range, or of two against a ratio, when the constants do
/// nothing else: attributes, shares, and distances of bound names, of labels and of objects. Not for `=` and `!=`, and
/// not where a distance is looked for in a way that follows from another distance.
bool hasPlainThreshold(const Condition& condition);

/// Numbers these thresholds, the distances of groups and the budgets of absorption, and the constants of confidence and
/// evidence, and sets RuleSet::thresholds, RuleSet::constants and RuleSet::structure.
void numberThresholds(RuleSet& rules);

}  // namespace cluxel::rules
