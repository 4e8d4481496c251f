// SPDX-License-Identifier: Apache-2.0
// Hands what hangs beside parted crowns to the tree in whose column it hangs.
#pragma once

#include <string>

#include "reasoning/reasoning_state.hpp"

namespace cluxel {

/// Free primitives with the label of a parted thing, within reach of objects of the class whose `split` has `gather`,
/// are cut cluxel by cluxel: each cluxel goes to the nearest of these objects by the plan distance from its top. What
/// was gathered may bring more near. Cost: look-ups around the free cluxels of the label.
void gatherFragments(ReasoningState& state, const std::string& class_iri);

}  // namespace cluxel
