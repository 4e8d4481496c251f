// SPDX-License-Identifier: Apache-2.0
// Small scenes of boxes for reasoning tests, and their results by name.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "rules/decide/reason.hpp"
#include "rules/reasoning_fixture.hpp"
#include "rules/testing/box_scene.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;

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

/// A street with one object of each class, and candidates that are easily confused with them.
BoxScene streetOfBoxes();

/// One line per object, sorted and independent of numbering: "Tree{TreeTop: crown; TreeTrunk: trunk}".
std::vector<std::string> inWords(const BuiltBoxScene& built, const ReasoningResult& result);

/// The shipped outdoor rules with the tests' catalogue.
RuleSet outdoorRules();

}  // namespace cluxel::testing
