// SPDX-License-Identifier: Apache-2.0
// Why a primitive became what it became, why it is nothing else, and what would have changed that.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cluxel/reasoning/reason.hpp"

namespace cluxel {

/// The change of one measured value that takes a test to its other side.
struct NeededChange {
  std::string test;
  double measured = 0, threshold = 0;  ///< in `unit`: degrees for angles
  std::string unit;
  double margin = 0;  ///< how far the value is from the threshold, always >= 0
};

/// The least that would have turned a decision, if one test can do that.
struct TurningPoint {
  std::vector<NeededChange> changes;  ///< all of them are needed
  bool accepted = false;              ///< what would come out then
  std::string outcome;
};

struct ExplainedDecision {
  Decision decision;
  std::string class_iri;
  std::optional<TurningPoint> least_change;  ///< towards the other verdict; absent when no single branch can turn it
};

struct Explanation {
  PrimitiveIndex primitive = 0;
  std::optional<SemanticObject> object;      ///< what it belongs to; of a parted primitive the first in order of ids
  std::vector<ExplainedDecision> decisions;  ///< about this primitive, in the order they were taken
  std::string note;                          ///< how it got there without a decision of its own: found, absorbed
};

/// Runs the stage again with a probe at the primitive. The scene may be a piece of the map that holds its surroundings.
Explanation explain(const Scene& scene, const RuleSet& rules, const ReasoningContext& context,
                    PrimitiveIndex primitive);

/// The same for the primitive that decided an object.
Explanation explain(const Scene& scene, const RuleSet& rules, const ReasoningContext& context,
                    const SemanticObject& object, const Decision& decision);

/// For people: the way to the verdict, then why not each other class, then the least change.
std::string textOf(const Explanation& explanation, const RuleSet& rules, const Scene& scene);
std::string jsonOf(const Explanation& explanation, const RuleSet& rules, const Scene& scene);

}  // namespace cluxel
