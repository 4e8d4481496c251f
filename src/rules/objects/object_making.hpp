// SPDX-License-Identifier: Apache-2.0
// Turns accepted candidates into objects, and gives these their fragments.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// Makes an object of what is bound to the parts of `accept`. Fragments of a shared part are claimed; `splitShared`
/// divides them later. The object's decision and confidence are those of the last decision recorded.
void makeObject(ReasoningState& state, const Rule& rule, const AcceptLeaf& accept, Bindings bindings);

/// Adds the group to the part of the object that has the leaf's class; creates that part when it is missing.
void joinRelated(ReasoningState& state, const Rule& rule, OwnerIndex related,
                 const std::pair<std::string, std::string>& as, const std::vector<FragmentIndex>& group);

}  // namespace cluxel::rules
