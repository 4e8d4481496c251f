// SPDX-License-Identifier: Apache-2.0
// One step of the reasoning stage: the classes of one stratum.
#pragma once

#include <string>
#include <vector>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// Makes the objects of the stratum's classes from what is free, and tells the oracle of all objects so far.
void decideStratum(ReasoningState& state, const std::vector<std::string>& stratum);

}  // namespace cluxel::rules
