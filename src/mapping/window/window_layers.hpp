// SPDX-License-Identifier: Apache-2.0
// Writes what was decided in a window into the layers of its tiles and the records of its objects.
#pragma once

#include <vector>

#include "mapping/window/map_window.hpp"
#include "mapping/window/window_decision.hpp"

namespace cluxel::mapping {

/// Undecided primitives keep their objects and traces. `former`: formerNumbers(); `wide`: wideObjectsIn().
void writeLayers(rdf::WriteTransaction& transaction, const MapWindow& window, const WindowDecision& decision,
                 const OutputChanges& changes, const std::vector<std::uint32_t>& former,
                 const std::vector<rules::SemanticObject>& wide, const InputOf& input_of);

}  // namespace cluxel::mapping
