// SPDX-License-Identifier: Apache-2.0
// The height of a map's ground at some places.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "mapping/map_reader.hpp"

namespace cluxel::mapping {

/// The ground [m, map] at each place [m, map]. In a tile without points it goes on as at the border of the nearest of
/// the tiles around it; absent where there is none of these. Throws Error (StoreUnavailable) for a damaged map. Memory:
/// nine tiles. Cost: some 50 us for each tile with places.
std::vector<std::optional<double>> groundHeightsAt(const MapReader& map, std::span<const Eigen::Vector2d> places);

}  // namespace cluxel::mapping
