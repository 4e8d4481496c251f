// SPDX-License-Identifier: Apache-2.0
// Gives misfits at the borders of objects to the object they belong to, by evidence and never by enclosing boxes.
#pragma once

#include "reasoning/reasoning_state.hpp"

namespace cluxel {

/// Absorbs for the objects numbered `first` and above, by their specs that are `late` or not. A free piece goes to the
/// object that most of its outward cluxel edges lead to; equal shares to the smaller gap, then to the object whose
/// members come first. More than `max_fraction_of_points` of an object's own points is never absorbed.
void absorbMisfits(ReasoningState& state, std::size_t first, bool late);

}  // namespace cluxel
