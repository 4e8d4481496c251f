// SPDX-License-Identifier: Apache-2.0
// Evidence as log-odds: what speaks for a candidate and what against it.
#pragma once

#include <vector>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// log(p / (1 - p)); `p` is kept within 0.0001 of 0 and 1.
double logOdds(double probability);
double probabilityOf(double log_odds);

/// The log-odds that the candidate is what the leaf says: those of the leaf's confidence plus those of every line of
/// evidence of the rule and of the leaf. Appends one step for the confidence and one for each line to `steps` when
/// given.
double weigh(const ReasoningState& state, const Rule& rule, const AcceptLeaf& accept, const Bindings& bindings,
             std::vector<EvidenceStep>* steps = nullptr);

/// What a line adds for a measured value.
double logOddsOf(const EvidenceLine& line, double value);

}  // namespace cluxel::rules
