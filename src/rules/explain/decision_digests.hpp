// SPDX-License-Identifier: Apache-2.0
// Digests of what was decided about each primitive. A run over a part of a scene that gives a primitive the digest of
// the whole run took the same decisions about it.
#pragma once

#include <cstdint>
#include <vector>

#include "perception/segments/scene.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::rules {

/// For each primitive a hash of all decisions that had it as a seed, in their order, with every measured value, and of
/// the objects that own some of it. Numbers of primitives and of decisions do not enter.
std::vector<std::uint64_t> decisionDigests(const perception::Scene& scene, const ReasoningResult& result);

}  // namespace cluxel::rules
