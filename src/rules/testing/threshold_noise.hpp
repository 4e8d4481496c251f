// SPDX-License-Identifier: Apache-2.0
// Finds thresholds where measurement noise decides the outcome for many things of a scene.
#pragma once

#include <vector>

#include "rules/decide/reason.hpp"

namespace cluxel::rules {

/// When a threshold is reported.
struct NoiseParams {
  double min_share = 0.1;      ///< smallest share of the tested things that lie within the noise of the threshold
  std::size_t min_tests = 20;  ///< smallest number of tested things
};

/// A test of an attribute against a number, and what a scene's things measure there.
struct NoisyThreshold {
  SourceLocation at;
  std::string rule_id, test;  ///< in words
  perception::Attribute attribute = perception::Attribute::Height;
  double noise = 0;        ///< SI
  std::size_t tested = 0;  ///< decisions of the rule that came to the test
  std::size_t near = 0;    ///< of these, measured no farther from the threshold than the noise
};

/// The noise of an attribute near a threshold is half of the difference between two halves of a thing, each with every
/// second of its cluxels: the median over up to 200 primitives of the rule's labels that measure between half and twice
/// the threshold. Tests of other bound names count with primitives of all labels. Tests relative to another attribute,
/// of counts and of what is known of whole primitives only are left out, and so are those of which fewer than five such
/// primitives are there. Sorted by share, largest first.
std::vector<NoisyThreshold> thresholdsWithinNoise(const perception::Scene& scene, const RuleSet& rules,
                                                  const ReasoningContext& context, const NoiseParams& params = {});

/// The same as warnings, each at its test.
std::vector<Diagnostic> warningsOf(const std::vector<NoisyThreshold>& thresholds);

}  // namespace cluxel::rules
