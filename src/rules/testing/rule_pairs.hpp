// SPDX-License-Identifier: Apache-2.0
// Finds pairs of rules that accept the same thing when no evidence decides between them.
#pragma once

#include <vector>

#include "cluxel/error.hpp"
#include "rules/language/rule_set.hpp"

namespace cluxel::rules {

/// Warnings, by the later rule of the pair, of two kinds:
/// - rivals of one stratum that both accept a thing, while neither has evidence, or both have the same;
/// - a rule whose every thing is also accepted by an earlier rule without evidence, so that it never gets one.
/// Each names a witness as the `primitives:` of a rule test: one box that each of the two rules, run alone, makes an
/// object. Only things of one primitive are looked for, so there may be more such pairs. Rules that cut slices out of
/// their seeds, or ask the map, are left out. Cost: up to some hundred scenes of one box for each pair of leaves.
std::vector<Diagnostic> checkRulePairs(const RuleSet& rules);

}  // namespace cluxel::rules
