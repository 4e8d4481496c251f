// SPDX-License-Identifier: Apache-2.0
// Unchanged objects near rays of added or removed clouds: their presence has to be computed again.
#pragma once

#include <Eigen/Geometry>
#include <set>
#include <vector>

#include "mapping/build/tile_stages.hpp"
#include "mapping/clouds/cloud.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/presence/ray_targets.hpp"
#include "mapping/window/map_window.hpp"

namespace cluxel::mapping {

/// The objects, without class-wide ones, that rays in these boxes may pass. Their presence depends on the clouds of
/// these rays.
std::set<ContentHash> passedObjects(const rdf::ReadTransaction& transaction,
                                    const std::vector<Eigen::AlignedBox3d>& rays);

/// What rays are compared with, of objects that have records. The stored layers of their tiles must be those of the
/// stored outputs. Reads about two hundred tiles at a time.
std::vector<RayTarget> targetsOf(const rdf::ReadTransaction& transaction, const ParsedInputs& parsed,
                                 TileStages& stages, const std::set<ContentHash>& objects);

/// Computes and tells when those of `objects` were there that the window does not hold as a whole, and how many rays
/// passed them (tellPresence(), targetsOf()).
void updatePassedObjects(rdf::WriteTransaction& transaction, const ParsedInputs& parsed, TileStages& stages,
                         const std::vector<Cloud>& clouds, const std::set<ContentHash>& objects,
                         const MapWindow& window, unsigned threads);

}  // namespace cluxel::mapping
