// SPDX-License-Identifier: Apache-2.0
// The observed graph around a change: facts of what was decided anew replace those of what is gone.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "cluxel/progress.hpp"
#include "mapping/clouds/cloud.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/layers/semantic_state.hpp"
#include "mapping/presence/ray_targets.hpp"
#include "mapping/window/map_window.hpp"
#include "mapping/window/window_change.hpp"
#include "mapping/window/window_decision.hpp"
#include "mapping/window/window_statements.hpp"

namespace cluxel::mapping {

/// Former objects and primitives of tiles that are decided anew. Their facts are removed unless they are written again.
struct RetiredThings {
  std::set<ContentHash> objects, primitives;
};

/// What the facts around a change follow from.
struct WindowFacts {
  const ParsedInputs& parsed;
  const TileStages& stages;
  const std::vector<Cloud>& clouds;
  const std::vector<SeenCloud>& clouds_before;
  const DecidedWindow& decided;
  const WindowStatements& statements;
  const RetiredThings& retired;               ///< of which no fact stays that is not told again
  const WayGraph* ways = nullptr;             ///< null when they are as before
  const std::set<std::string>& more_patches;  ///< of the ground (IRIs) that nothing may touch any more
  unsigned threads = 1;
  LaterTargets* later = nullptr;  ///< gets the objects that were made, if rays are not to be looked at yet
  bool has_other_rays = false;    ///< rays of another map pass objects that stay, though `clouds_before` has its clouds
};

/// Updates graph `observed` and the stored rows of presence and class-wide objects. The result is that of a computation
/// over the whole map. Call it before the layers of tiles are written.
void writeWindowFacts(rdf::WriteTransaction& transaction, const WindowFacts& facts);

}  // namespace cluxel::mapping
