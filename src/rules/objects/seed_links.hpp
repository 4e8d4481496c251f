// SPDX-License-Identifier: Apache-2.0
// The pairs of fragments that a rule's `group` may join.
#pragma once

#include <cstddef>
#include <vector>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// Two fragments within the tolerances of a group.
struct SeedLink {
  double gap = 0;            ///< between their cluxels [m]; 0 when an edge of the cluxel graph joins them
  std::size_t a = 0, b = 0;  ///< positions among the members, a < b
};

/// The links between `members` (in canonical order), shortest gap first, then by a and b. Cost: a search around those
/// cluxels that lie within the tolerances of the bounds of another member.
std::vector<SeedLink> seedLinks(const ReasoningState& state, const GroupSpec& group,
                                const std::vector<FragmentIndex>& members);

}  // namespace cluxel::rules
