// SPDX-License-Identifier: Apache-2.0
// What is measured between two things, and whether a relation of the scene holds between them.
#pragma once

#include <limits>
#include <optional>

#include "cluxel/reasoning/rule_condition.hpp"
#include "reasoning/reasoning_state.hpp"

namespace cluxel {

/// Gaps are measured no farther than this, and looked for a little farther than a test asks.
inline constexpr double kFarthestMeasure_m = 50.0, kMeasureMargin_m = 0.5;

/// The measure from `a` to `b`. Gaps beyond `limit_m` may come out as infinity.
double measurePair(const ReasoningState& state, PairMeasure measure, const Thing& a, const Thing& b,
                   double limit_m = std::numeric_limits<double>::infinity());

/// The smallest measure of a relation from a primitive of `a` to one of `b`; absent when it does not hold. Pieces of
/// one primitive, which the scene cannot relate, are related by their cluxels.
std::optional<double> relationMeasure(const ReasoningState& state, RelationKind kind, const Thing& a, const Thing& b);

/// All pieces that a relation of this kind leads to from `a`, with their measures; not those of `a` itself.
std::vector<std::pair<PieceIndex, double>> relatedPieces(const ReasoningState& state, RelationKind kind,
                                                         const Thing& a);

}  // namespace cluxel
