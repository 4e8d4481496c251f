// SPDX-License-Identifier: Apache-2.0
// Assigns free fragments at the border of objects to the object they belong to. The evidence is cluxel adjacency and
// distance, never an enclosing box.
#pragma once

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// Absorbs for the objects numbered `first` and above, using their specs whose `late` flag equals `late`. A free
/// fragment goes to the object with the largest share of its outward cluxel edges; ties go to the smaller gap, then to
/// the object whose first member comes first in canonical order. An object absorbs at most `max_fraction_of_points` of
/// its own points.
void absorbMisfits(ReasoningState& state, std::size_t first, bool late);

}  // namespace cluxel::rules
