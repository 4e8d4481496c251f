// SPDX-License-Identifier: Apache-2.0
// Small worlds of boxes for reasoning tests, and what came of them by name.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "cluxel/reasoning/reason.hpp"
#include "reasoning/box_scene.hpp"
#include "reasoning/reasoning_fixture.hpp"

namespace cluxel::testing {

inline BoxPrimitive box(const std::string& name, PrimitiveLabel label, Eigen::Vector3d center, Eigen::Vector3d size) {
  BoxPrimitive made;
  made.name = name;
  made.label = label;
  made.center = center;
  made.size = size;
  return made;
}

inline constexpr auto kGroundLabel = PrimitiveLabel::HorizontalPlane;
inline constexpr auto kWall = PrimitiveLabel::VerticalPlane;
inline constexpr auto kColumn = PrimitiveLabel::Column;
inline constexpr auto kSmall = PrimitiveLabel::SmallStructure;
inline constexpr auto kScatter = PrimitiveLabel::Scatter;

/// A street with one of everything, and things that are easily taken for others.
BoxScene streetOfBoxes();

/// "Tree{TreeTop: crown; TreeTrunk: trunk}" for each object, sorted: what came out, whatever the numbering.
std::vector<std::string> inWords(const BuiltBoxScene& built, const ReasoningResult& result);

/// The shipped outdoor rules with the tests' catalogue.
RuleSet outdoorRules();

}  // namespace cluxel::testing
