// SPDX-License-Identifier: Apache-2.0
// Occluders: delivery vans that stand before things on one visit, so that the laser does not see the things.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/site/campus.hpp"
#include "simulation/site/campus_random.hpp"

namespace cluxel::simulation {

/// Whether vans stand before objects of this kind: signs, bushes and small objects that are lower than a van.
bool canBeHidden(const CampusObject& object);

/// Where a van stands between the robot's route and the object, half a metre from it and along the route (T_map_van;
/// x forward, origin on the ground). Nothing when other surfaces or stops of the campus or the route are in the way, or
/// the object is far from the route. `route`: the stops of the first visit; those of the campus may be fewer.
std::optional<Eigen::Isometry3d> placeOfVan(const Campus& campus, const std::vector<Eigen::Isometry3d>& route,
                                            const CampusObject& hidden);

/// Adds a van to the campus and returns its number.
std::int32_t addVan(Campus& campus, const Eigen::Isometry3d& T_map_van, CampusRandom random);

}  // namespace cluxel::simulation
