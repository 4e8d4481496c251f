// SPDX-License-Identifier: Apache-2.0
// The fewest simple tests that hold for some things and for no others.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "perception/segments/primitive.hpp"

namespace cluxel::tasks {

using AttributeValues = std::array<double, perception::kAttributeCount>;

/// `attribute >= value` or `attribute <= value`, SI.
struct AttributeCut {
  perception::Attribute attribute = perception::Attribute::Height;
  bool at_least = true;
  double value = 0;

  bool holds(const AttributeValues& values) const;
};

/// The least margin between the two sides, in units of the attribute's spread over all things (the range of its middle
/// half or its standard deviation). With a narrower one, noise would decide.
inline constexpr double kLeastSpread = 0.1;

/// One cut, or else two, that all of `wanted` pass and none of `others` does: those with the widest margin, at round
/// numbers. Empty when there are no others; absent when no two cuts do it. Attributes that tell how a thing was seen
/// (views, intensity, number of cluxels, probability) are not used. Cost: linear in the things, for each pair of cuts.
std::optional<std::vector<AttributeCut>> separatingCuts(std::span<const AttributeValues> wanted,
                                                        std::span<const AttributeValues> others);

/// As a condition of a rule file: "height >= 2.5 m".
std::string conditionText(const AttributeCut& cut);

}  // namespace cluxel::tasks
