// SPDX-License-Identifier: Apache-2.0
// How far the rules of a set look from the primitives that a step is about, and what forbids deciding locally.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rules/language/rule_set.hpp"

namespace cluxel::rules {

struct LocalReach {
  /// The distance in plan view from the members of a step beyond which nothing matters to it [m]. Absent when no such
  /// bound follows from the rules' text.
  std::optional<double> reach_m;
  std::string obstacle;  ///< why it is absent: "rule 'a/b' asks the map"
};

/// Members of a step are all primitives that it binds, joins, compares or lets grow. Absent for:
/// - `ask:`;
/// - class-wide objects (`merge_into: class`) that take more than their seeds, split or absorb, or that stand beside
///   other objects of the class: they would be measured through the whole map;
/// - a find or an absorption that is looked up by `vertical_gap` or `axis_distance`, and such measures to labels or
///   objects: they have no bound in plan view;
/// - `merge_into: related` after a test that holds for something far away.
LocalReach localReach(const RuleSet& rules);

/// How many of the first strata decide about each primitive alone, looking at nothing else, and make a class-wide
/// object: what they take is the same in every run over the primitive.
std::size_t strataOfLoneSeeds(const RuleSet& rules);

/// The strata of a set in their order, divided behind those of lone seeds.
struct DividedStrata {
  std::span<const std::vector<std::string>> lone, later;
};
DividedStrata dividedStrata(const RuleSet& rules);

}  // namespace cluxel::rules
