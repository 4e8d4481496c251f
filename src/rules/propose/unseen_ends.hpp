// SPDX-License-Identifier: Apache-2.0
// Ends of things that no scan shows: cut off by the upper edge of the field of view, or hidden by something nearer.
#pragma once

#include "rules/propose/condition_eval.hpp"

namespace cluxel::rules {

/// An end at most this far below the upper edge of a scan's field of view is cut off by it [rad]: the beams of spinning
/// lasers lie 0.3 degrees apart or more.
inline constexpr double kEdge_rad = 0.4 * 3.14159265358979323846 / 180;
/// What hides an end stands at most this far before it, in plan view [m]: parked cars, hedges, people.
inline constexpr double kHiding_m = 6.0;
/// Whether an end is hidden is decided at a place this far beyond it [m].
inline constexpr double kBeyond_m = 0.15;

/// Whether the real attribute may be larger (or for `bottom` lower) than what was measured, because no scan that saw
/// the candidate shows the end:
/// - `top`: no scan's field of view reaches beyond it, and one ends there;
/// - `bottom`: in every scan something hides the place below it, and it is more than 0.3 m above the ground;
/// - `height`, `elevation_span`: either of them;
/// - `length`, `horizontal_extent`: in every scan something hides the place beyond one of its two ends.
/// Scans of which the place of the sensor is unknown say nothing; without others every end counts as seen. A top that
/// lies above all known fields of view was seen by such a scan.
/// Cost: the cluxels of the candidate; for what is hidden also those around it, for each scan.
bool isEndUnseen(const ReasoningState& state, const Candidate& candidate, perception::Attribute attribute);

enum class Truth : std::uint8_t { No, Unseen, Yes };

/// The answer to a test when ends may be unseen. A test of an attribute is unseen when a thing that goes on beyond its
/// unseen end could change the answer: of a top measured at 3 m, `top >= 2 m` is true and `top <= 4 m` is unseen. `all`
/// and `any` follow Kleene's three-valued logic: the minimum and the maximum of the operands, where unseen lies between
/// false and true. Slices and all other tests are never unseen.
Truth truthOf(const ReasoningState& state, const Bindings& bindings, ConditionEvaluator& evaluator,
              const Condition& condition);

}  // namespace cluxel::rules
