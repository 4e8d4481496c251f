// SPDX-License-Identifier: Apache-2.0
// Assigns free fragments beside split crowns to the nearest trunk in plan view.
#pragma once

#include <string>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// Takes the free fragments that have a label of a split crown and lie within `gather` of objects of the class whose
/// crowns were split since the last call. Each of their cluxels goes to the object whose trunk top is nearest in plan
/// view. Repeats while objects grow. Cost: grid look-ups around the free cluxels of these labels.
void gatherFragments(ReasoningState& state, const std::string& class_iri);

}  // namespace cluxel::rules
