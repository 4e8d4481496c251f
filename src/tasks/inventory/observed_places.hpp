// SPDX-License-Identifier: Apache-2.0
// Which places of a map its scans observed: what is missing there is not merely hidden.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/map_reader.hpp"

namespace cluxel::tasks {

/// A place where something of some height should stand.
struct AskedPlace {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< [m, map]
  double height_m = 1;                           ///< above the ground
};

/// Whether rays of a scan from within `view_m` look at each place (perception::LookingRays). A scan whose rays start at
/// no known place looks at it when it has a point within 1 m of the upright line. Not where the map has no ground.
/// Memory: one scan. Cost: about 0.1 us for each ray of the scans that may look at a place at which none before them
/// did.
std::vector<bool> observedPlaces(const mapping::MapReader& map, const std::vector<AskedPlace>& places, double view_m);

}  // namespace cluxel::tasks
