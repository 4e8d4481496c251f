// SPDX-License-Identifier: Apache-2.0
// Objects of a window that a change leaves as they are.
#pragma once

#include <vector>

#include "mapping/window/map_window.hpp"
#include "mapping/window/window_decision.hpp"

namespace cluxel::mapping {

/// Whether the window holds all of an object; false for a class-wide one.
bool isInside(const ObjectRecord& record, const MapWindow& window);

/// Whom the cluxels of a window belong to after a change, by number in `objects`.
struct WindowOwners {
  std::vector<ContentHash> objects;
  std::vector<std::uint32_t> owner_of;  ///< by cluxel of the scene; kNoObject for none
};
WindowOwners ownersIn(const MapWindow& window, const WindowDecision& decision,
                      const std::vector<std::uint32_t>& former);

/// The objects that the window holds as a whole and that are not decided anew, sorted by id, with the numbers of its
/// scene; no class-wide ones. They have no primitives: the window may hold a part of these.
std::vector<rules::SemanticObject> keptObjects(const rdf::ReadTransaction& transaction, const MapWindow& window,
                                               const WindowDecision& decision,
                                               const std::vector<std::uint32_t>& former);

/// The class-wide objects that have or had cluxels in the window, with all that they have there now, decided anew or
/// not. They have no primitives; one that is gone from the window has no parts.
std::vector<rules::SemanticObject> wideObjectsIn(const rdf::ReadTransaction& transaction, const MapWindow& window,
                                                 const WindowDecision& decision,
                                                 const std::vector<std::uint32_t>& former);

}  // namespace cluxel::mapping
