// SPDX-License-Identifier: Apache-2.0
// The thresholds of a rule set that a run compares with measured numbers and does nothing else with. When only these
// change, the run before tells what may turn out otherwise; see ThresholdMargins.
#pragma once

#include "rules/language/rule_set.hpp"

namespace cluxel::rules {

/// True for a test of one measured number against a constant: an attribute, or the share of points with some labels.
/// Not for distances: how far rules look follows from their thresholds.
bool hasPlainThreshold(const Condition& condition);

/// Numbers these thresholds from 1 in the order written (Condition::threshold), and sets RuleSet::thresholds and
/// RuleSet::structure.
void numberThresholds(RuleSet& rules);

}  // namespace cluxel::rules
