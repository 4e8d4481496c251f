// SPDX-License-Identifier: Apache-2.0
// The steps of the reasoning stage: the classes of one stratum, and the end of the run.
#pragma once

#include <string>
#include <vector>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// Makes the objects of the stratum's classes from what is free, and tells the oracle of all objects so far.
void decideStratum(ReasoningState& state, const std::vector<std::string>& stratum);

/// What is absorbed after all strata, and the outcome of the run.
ReasoningResult finishedRun(ReasoningState& state);

}  // namespace cluxel::rules
