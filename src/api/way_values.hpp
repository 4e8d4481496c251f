// SPDX-License-Identifier: Apache-2.0
// Options of ways as requests, and positions as values of the facade.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "cluxel/ground_ways.hpp"
#include "tasks/ways/route.hpp"

namespace cluxel {

/// Not checked.
tasks::WayRequest wayRequestOf(const GroundOptions& options);
/// The shortest text that reads back the same.
std::string exactText(double number);
/// As tasks::placeNamed() takes it.
std::string textOf(const Place& place);
GroundPosition groundPositionOf(const Eigen::Vector2d& p_map);
std::vector<GroundPosition> lineOf(const std::vector<Eigen::Vector2d>& places);

}  // namespace cluxel
