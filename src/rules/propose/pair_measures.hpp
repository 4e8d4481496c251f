// SPDX-License-Identifier: Apache-2.0
// Distances, adjacency and relations between two candidates.
#pragma once

#include <limits>
#include <optional>

#include "rules/decide/reasoning_state.hpp"
#include "rules/language/rule_condition.hpp"

namespace cluxel::rules {

/// The measure from `a` to `b`: metres, or a share for AdjacentFraction. Gaps above `limit_m` are infinite.
double measurePair(const ReasoningState& state, PairMeasure measure, const Candidate& a, const Candidate& b,
                   double limit_m = std::numeric_limits<double>::infinity());

/// The smallest measure of a relation from a primitive of `a` to one of `b`; absent when the relation does not hold.
/// The scene does not relate a primitive to itself: fragments of one primitive are related through their cluxels.
std::optional<double> relationMeasure(const ReasoningState& state, perception::RelationKind kind, const Candidate& a,
                                      const Candidate& b);

/// All fragments that a relation of this kind leads to from `a`, with the measures. Fragments of `a` are left out.
std::vector<std::pair<FragmentIndex, double>> relatedFragments(const ReasoningState& state,
                                                               perception::RelationKind kind, const Candidate& a);

}  // namespace cluxel::rules
