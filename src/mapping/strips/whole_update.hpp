// SPDX-License-Identifier: Apache-2.0
// The layers above the tiles, computed for the whole map: at once, or strip by strip when it is large.
#pragma once

#include "mapping/window/local_update.hpp"

namespace cluxel::mapping {

/// Computes all layers and facts. A map that is larger than UpdateParams::whole_cluxels is decided strip by strip, with
/// the same result, when all rules have a reach. Memory: decision 0121.
SemanticUpdate updateAll(const LayerWork& work, OutputChanges changes);

/// Whether the rules allow for strips: all have a reach, and only the ground may be a class-wide object.
bool canBeInStrips(const LayerWork& work);

/// Other SPARQL rules, or another ontology of the same classes: only what is inferred changes. Absent when something
/// else did.
std::optional<SemanticUpdate> updateInference(const LayerWork& work, const OutputChanges& changes);

}  // namespace cluxel::mapping
