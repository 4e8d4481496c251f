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

/// A link, or two fragments that one of the distances keeps apart, in a run with margins. While the threshold stays on
/// its side of the distance, the link stays as it is, or does not come about. When it does not matter that the two are
/// linked, it does not matter where the threshold is.
struct LinkNote {
  std::uint32_t threshold = 0;  ///< in RuleSet::thresholds
  double distance_m = 0;
  std::size_t a = 0, b = 0;  ///< positions among the members
};

struct SeedLinks {
  std::vector<SeedLink> links;
  std::vector<LinkNote> notes;
};

/// The links that a group had among some members.
struct KnownLinks {
  std::vector<FragmentIndex> members;
  SeedLinks links;
};

/// The links between `members` (in canonical order), shortest gap first, then by a and b. Cost: a search around those
/// cluxels that lie within the tolerances of the bounds of another member. What always matters is noted in the margins.
/// The gaps between fragments stay as they are until these are cut: as long, the links among fewer members than before
/// are some of those that are `known`, and so are the notes, as far as is looked; farther ones narrow no margin. Other
/// links are known from now on.
SeedLinks seedLinks(const ReasoningState& state, const GroupSpec& group, const std::vector<FragmentIndex>& members,
                    KnownLinks* known = nullptr);

}  // namespace cluxel::rules
