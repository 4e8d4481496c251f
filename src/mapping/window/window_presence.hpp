// SPDX-License-Identifier: Apache-2.0
// When the objects of a window were there, and how many rays passed them.
#pragma once

#include <optional>
#include <set>
#include <span>
#include <vector>

#include "mapping/window/window_facts.hpp"
#include "perception/visibility/presence.hpp"
#include "perception/visibility/ray_bundle.hpp"

namespace cluxel::mapping {

struct KeptPresence {
  ContentHash object;
  std::optional<perception::Presence> times;
  std::optional<perception::RayCounts> rays;
};

struct WindowPresence {
  std::vector<std::optional<perception::Presence>> times;  ///< of the objects that were made
  std::vector<std::optional<perception::RayCounts>> rays;
  std::vector<KeptPresence> kept;  ///< of objects that the window holds as a whole
};

/// Computes, stores and tells what follows from the rays of all clouds for `targets`: objects that are written already.
/// Rows of `gone` go, unless they are targets. Each scan is read once.
void tellPresence(rdf::WriteTransaction& transaction, std::span<const RayTarget> targets,
                  const std::vector<Cloud>& clouds, const std::set<ContentHash>& gone, unsigned threads);

/// Computes and stores what follows from the rays of the map's clouds; nothing where that is to be done later.
WindowPresence updatePresenceIn(rdf::WriteTransaction& transaction, const WindowFacts& facts,
                                const std::vector<rules::SemanticObject>& made);

}  // namespace cluxel::mapping
