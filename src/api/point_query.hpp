// SPDX-License-Identifier: Apache-2.0
// Points of a map as values.
#pragma once

#include "cluxel/point_cloud.hpp"
#include "mapping/map_reader.hpp"

namespace cluxel {

std::vector<Cloud> cloudsOf(const mapping::MapReader& map);
/// Throws Error (NotFound) when the map has no scan of that id.
PointCloud pointsOf(const mapping::MapReader& map, const Cloud& cloud);
/// Throws Error (NotFound) when the map has no object of that IRI.
PointCloud pointsOf(const mapping::MapReader& map, const Object& object);

}  // namespace cluxel
