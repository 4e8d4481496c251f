// SPDX-License-Identifier: Apache-2.0
// Ends the sharing of primitives among the objects of one class: each gets its part, the rest is free again.
#pragma once

#include "reasoning/reasoning_state.hpp"

namespace cluxel {

void partShared(ReasoningState& state);

}  // namespace cluxel
