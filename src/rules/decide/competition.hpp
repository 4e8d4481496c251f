// SPDX-License-Identifier: Apache-2.0
// Decides a stratum of classes by evidence: rules propose candidates over what is free, and rivals are settled.
#pragma once

#include <span>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// Lets the rules propose and the candidates with the highest score take their fragments. What the losers leave is
/// proposed again, until no candidate wins. No decision is reopened.
void compete(ReasoningState& state, std::span<const Rule* const> rules);

}  // namespace cluxel::rules
