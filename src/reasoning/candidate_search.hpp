// SPDX-License-Identifier: Apache-2.0
// Looks up the pieces that conditions tie to bound things.
#pragma once

#include <functional>
#include <vector>

#include "reasoning/reasoning_state.hpp"

namespace cluxel {

/// The pieces that may pass `conditions` as `name`, by the first condition that ties it to a bound thing: a superset
/// of those that do, in canonical order. Only pieces for which `wanted` holds.
std::vector<PieceIndex> candidatesFor(const ReasoningState& state, const std::vector<Condition>& conditions,
                                      const std::string& name, const Bindings& bindings,
                                      const std::function<bool(PieceIndex)>& wanted);

/// Those of them that do pass.
std::vector<PieceIndex> findPassing(const ReasoningState& state, const Rule& rule,
                                    const std::vector<Condition>& conditions, const std::string& name,
                                    const Bindings& bindings, const std::function<bool(PieceIndex)>& wanted);

/// The piece or pieces that `choice` takes of the candidates (not empty).
std::vector<PieceIndex> choose(const ReasoningState& state, Choice choice, const std::vector<PieceIndex>& candidates,
                               const Thing* nearest_to);

}  // namespace cluxel
