// SPDX-License-Identifier: Apache-2.0
// What the rules of a class say of a thing that no other class has taken before.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rules/decide/local_run.hpp"
#include "rules/decide/reason.hpp"

namespace cluxel::rules {

/// What one rule said of the thing.
struct Consideration {
  Decision decision;       ///< when it is no seed: the tests of a seed
  bool is_seed = false;    ///< the rule looked at it, alone or in a group
  bool has_label = false;  ///< its label is one of the rule's
};

/// Runs the classes that come before `class_iri`, but keeps `primitives` from them. Then each rule of the class, or of
/// one below it, judges the groups that hold some of the primitives. Rules that look at objects of their own stratum
/// see none. Decisions tell what would have changed them. In the order of the rules. Cost: one run of the stage.
std::vector<Consideration> considerFor(const perception::Scene& scene, const RuleSet& rules,
                                       const ReasoningContext& context, const std::string& class_iri,
                                       const std::vector<perception::PrimitiveIndex>& primitives);

/// The same for the dirty primitives of a window around them, in which nothing else changed; `reach_m` is that of
/// localReach(). Keeping the thing from other classes changes the scene: as in LocalRun, a seam shows that the change
/// ends within the window. Absent when there is none, or when the rules may look beyond it.
std::optional<std::vector<Consideration>> considerIn(const LocalInput& window, const RuleSet& rules,
                                                     const ReasoningContext& context, const std::string& class_iri,
                                                     double reach_m);

}  // namespace cluxel::rules
