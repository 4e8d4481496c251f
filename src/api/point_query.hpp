// SPDX-License-Identifier: Apache-2.0
// Points of a map as values.
#pragma once

#include <string>

#include "cluxel/point_cloud.hpp"
#include "mapping/map_reader.hpp"
#include "mapping/regions/answered_clouds.hpp"

namespace cluxel {

std::vector<Cloud> cloudsOf(const mapping::MapReader& map);
/// `kept` is of the commit that `map` reads. Throws Error (NotFound) when the map has no scan of that id.
PointCloud pointsOf(const mapping::MapReader& map, mapping::KeptAnswers& kept, const Cloud& cloud);
/// `object` as for tasks::objectNamed(). Throws Error (NotFound) as that does.
PointCloud pointsOf(const mapping::MapReader& map, mapping::KeptAnswers& kept, const std::string& object);

}  // namespace cluxel
