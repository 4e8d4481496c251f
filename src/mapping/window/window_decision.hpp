// SPDX-License-Identifier: Apache-2.0
// What the rules decide anew in a window, and which of the map's objects that replaces.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "mapping/layers/object_record.hpp"
#include "mapping/window/map_window.hpp"
#include "mapping/window/window_change.hpp"
#include "rules/decide/local_run.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

struct WindowDecision {
  std::vector<char> is_decided;       ///< by primitive: owners and trace are those of this run; others keep theirs
  std::vector<std::uint64_t> traces;  ///< by primitive, where it is decided
  /// All that a decided primitive belongs to, sorted by id; of class-wide objects what lies in decided primitives.
  std::vector<rules::SemanticObject> objects;
  std::map<ContentHash, ObjectRecord> replaced;  ///< former objects of decided and gone primitives, none class-wide
};

/// A window with all that is written of it.
struct DecidedWindow {
  const MapWindow& window;
  const WindowChange& change;
  const WindowDecision& decision;
  const std::vector<std::uint32_t>& former;        ///< formerNumbers()
  const std::vector<rules::SemanticObject>& wide;  ///< wideObjectsIn()
  const InputOf& input_of;
};

/// What the rules' run over the window starts from. Its layers are likely to be those of the run: strata of lone seeds
/// are expected to take what they took before. `lone_objects`: objectsOfLoneSeeds().
rules::LocalInput localInputOf(const MapWindow& window, const WindowChange& change,
                               const std::set<ContentHash>& lone_objects, double reach_m);

/// The map's tiles beyond the window that hold, or lie within reach of, open primitives in layers around the change.
/// Empty when the window is large enough for the rules to run.
perception::TileSet tilesBeyond(const MapWindow& window, const WindowChange& change, const OutputChanges& changes,
                                const rdf::ReadTransaction& transaction, const std::vector<std::uint32_t>& layers);

/// Decides the window by a run over it. Absent when the window is too small to tell what the change leads to: it lacks
/// tiles beyond the layers that the run has then, or those that are added to `lacking`.
std::optional<WindowDecision> decideIn(const MapWindow& window, const WindowChange& change,
                                       const rdf::ReadTransaction& transaction, rules::LocalRun& run,
                                       perception::TileSet& lacking);

}  // namespace cluxel::mapping
