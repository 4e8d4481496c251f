// SPDX-License-Identifier: Apache-2.0
// The room that the robot needs at a stop: things of the campus stay away from it.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "simulation/site/campus.hpp"

namespace cluxel::simulation {

/// The robot's room around a stop [m]. No surface but the ground comes nearer to the laser.
constexpr double kStopRoom_m = 0.5;

/// Whether the object, moved by `shift`, leaves the robot its room at a stop (the place of the laser). Seen from above
/// its surfaces lie farther away, or they hang over the laser by as much.
bool leavesRoom(const Campus& campus, std::int32_t instance, const Eigen::Vector3d& shift, const Eigen::Vector3d& stop);

/// Whether all surfaces of the campus but its ground do so, where they are.
bool hasRoom(const Campus& campus, const Eigen::Vector3d& stop);

}  // namespace cluxel::simulation
