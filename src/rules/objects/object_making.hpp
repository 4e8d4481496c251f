// SPDX-License-Identifier: Apache-2.0
// Turns accepted candidates into objects, and gives these their fragments.
#pragma once

#include <vector>

#include "rules/decide/decision_record.hpp"

namespace cluxel::rules {

/// Makes an object of what is bound to the parts of the leaf that accepted. Fragments of a shared part are claimed;
/// `splitShared` divides them later. The object's decision and confidence are those of the last decision recorded.
void makeObject(ReasoningState& state, const Rule& rule, Verdict verdict);

/// Adds the group to the part of the object that has the class of the leaf's first part; creates that part when it is
/// missing.
void joinRelated(ReasoningState& state, const Rule& rule, OwnerIndex related, const Verdict& verdict,
                 const std::vector<FragmentIndex>& group);

}  // namespace cluxel::rules
