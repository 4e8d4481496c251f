// SPDX-License-Identifier: Apache-2.0
// What rays tell of the objects of a map.
#pragma once

#include <optional>
#include <set>
#include <span>
#include <vector>

#include "mapping/clouds/cloud.hpp"
#include "mapping/presence/object_rows.hpp"
#include "mapping/presence/ray_targets.hpp"
#include "perception/visibility/presence.hpp"
#include "perception/visibility/ray_bundle.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// By target.
struct ObjectPresence {
  std::vector<std::optional<perception::Presence>> times;
  std::vector<std::optional<perception::RayCounts>> rays;
};

/// Computes and stores when objects were there, and how many rays passed the barriers among them, from the rays of all
/// clouds of the map. Of `gone` only the rows of those stay that are among `targets`. Cost: as for PassedRaysUpdate.
ObjectPresence updatePresence(rdf::WriteTransaction& transaction, std::span<const RayTarget> targets, Covered covered,
                              const std::vector<Cloud>& clouds, const std::set<ContentHash>& gone, unsigned threads);

}  // namespace cluxel::mapping
