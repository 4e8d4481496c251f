// SPDX-License-Identifier: Apache-2.0
// The smallest gaps between cluxels and some fragments, by one look around each cluxel that is near enough.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

inline constexpr double kGapRounding_m = 1e-9;

/// Whether two boxes may be within a distance.
inline bool isWithin(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b, double distance_m) {
  return a.squaredExteriorDistance(b) <= (distance_m + kGapRounding_m) * (distance_m + kGapRounding_m);
}

/// The box around the boxes of a fragment's cluxels [m, map].
inline Eigen::AlignedBox3d boundsOf(const FragmentTable& fragments, FragmentIndex fragment) {
  const Outline& outline = fragments.outlineOf(fragment);
  return {outline.min, outline.max};
}

struct FragmentGap {
  FragmentIndex fragment = 0;
  double gap_m = std::numeric_limits<double>::infinity();
};

/// The smallest gap [m] from `cluxels` to each of the fragments, which are different; infinite, or any larger number,
/// where it is more than `within_m`. Ascending by fragment.
std::vector<FragmentGap> gapsTo(const ReasoningState& state, std::span<const std::uint32_t> cluxels,
                                std::vector<FragmentIndex> fragments, double within_m);

}  // namespace cluxel::rules
