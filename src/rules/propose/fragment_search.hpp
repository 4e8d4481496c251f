// SPDX-License-Identifier: Apache-2.0
// Looks up fragments near the candidates that are already bound.
#pragma once

#include <functional>
#include <vector>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// How far a run with margins looks for what is within a distance [m]: it is known from when on a larger distance would
/// find more.
constexpr double searchedAround(double within_m) {
  return 1.25 * within_m + 0.01;
}

/// A superset of the fragments that pass `conditions` when bound to `name`, in canonical order, restricted to those for
/// which `is_eligible` holds. It is looked up by the first condition that relates `name` to a bound candidate; empty
/// when there is none.
std::vector<FragmentIndex> tiedFragments(const ReasoningState& state, const std::vector<Condition>& conditions,
                                         const std::string& name, const Bindings& bindings,
                                         const std::function<bool(FragmentIndex)>& is_eligible);

/// The fragments that pass all `conditions`, in canonical order.
std::vector<FragmentIndex> findPassing(const ReasoningState& state, const Rule& rule,
                                       const std::vector<Condition>& conditions, const std::string& name,
                                       const Bindings& bindings, const std::function<bool(FragmentIndex)>& is_eligible);

/// The fragment selected by `choice`, or all of them for Choice::All. `fragments` must not be empty. Ties go to the
/// first in canonical order.
std::vector<FragmentIndex> choose(const ReasoningState& state, Choice choice,
                                  const std::vector<FragmentIndex>& fragments, const Candidate* nearest_to);

}  // namespace cluxel::rules
