// SPDX-License-Identifier: Apache-2.0
// Evidence as log-odds: what speaks for a candidate and what against it.
#pragma once

#include <vector>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// The largest value that a line tells from larger ones.
double reachOf(const EvidenceLine& line);

/// log(p / (1 - p)); `p` is kept within 0.0001 of 0 and 1.
double logOdds(double probability);
double probabilityOf(double log_odds);

/// Fills in how likely the candidate is what the leaf says: the log-odds of the leaf's confidence plus those of every
/// line of evidence of the rule and of the leaf, one step for each.
void weigh(const ReasoningState& state, const Rule& rule, const AcceptLeaf& accept, const Bindings& bindings,
           Decision& decision);

/// What a line adds for a measured value.
double logOddsOf(const EvidenceLine& line, double value);

}  // namespace cluxel::rules
