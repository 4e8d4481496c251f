// SPDX-License-Identifier: Apache-2.0
// The layers above the tiles, computed for the whole map: at once, or strip by strip when it is large.
#pragma once

#include "mapping/window/local_update.hpp"

namespace cluxel::mapping {

/// Computes all layers and facts. A map that had layers before and is larger than UpdateParams::whole_cluxels is
/// decided strip by strip, with the same result, when all rules have a reach. Memory: some 600 bytes a cluxel at once;
/// of strips that of one with its border, and some 30 bytes a cluxel for the lists of objects.
SemanticUpdate updateAll(const LayerWork& work, const OutputChanges& changes);

/// Other SPARQL rules, or another ontology of the same classes: only what is inferred changes. Absent when something
/// else did.
std::optional<SemanticUpdate> updateInference(const LayerWork& work, const OutputChanges& changes);

}  // namespace cluxel::mapping
