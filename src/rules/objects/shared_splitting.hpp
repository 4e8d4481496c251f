// SPDX-License-Identifier: Apache-2.0
// Splits the shared fragments among the objects that claim them; what no object gets becomes free.
#pragma once

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

void splitShared(ReasoningState& state);

}  // namespace cluxel::rules
