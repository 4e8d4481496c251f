// SPDX-License-Identifier: Apache-2.0
// Runs one rule over its seeds one after the other: the first that accepts takes what is free.
#pragma once

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

void runRule(ReasoningState& state, const Rule& rule);

}  // namespace cluxel::rules
