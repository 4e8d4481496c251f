// SPDX-License-Identifier: Apache-2.0
// Refuses scans that cannot be of a place and would cost more than their points.
#pragma once

#include <map>

#include "perception/clustering/tile_points.hpp"

namespace cluxel::mapping {

/// Throws InputError naming the scan when its points are scattered over thousands of tiles with a few points in each (a
/// tile costs some 85 KB whatever it holds), or when many points of one tile lie kilometres above each other (objects
/// are searched for in plan view). Single stray points are no fault. Cost: one look at each point.
void requirePlausible(const scan::Scan& scan, const std::map<perception::TileKey, perception::ScanSegment>& segments);

}  // namespace cluxel::mapping
