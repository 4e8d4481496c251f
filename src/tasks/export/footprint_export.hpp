// SPDX-License-Identifier: Apache-2.0
// Footprints of objects as GeoJSON.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "tasks/export/map_export.hpp"

namespace cluxel::tasks {

/// Throws Error (InvalidArgument, Remedy::LocalFrame) for longitude and latitude of a map without coordinate system.
void writeFootprints(const mapping::MapReader& map, ExportFrame frame, const ByteSink& out);

/// From the map frame [m] to the rounded coordinates of a file. Throws as above.
using PlaceWriter = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;
PlaceWriter placesIn(ExportFrame frame, const mapping::MapInputs& inputs);

}  // namespace cluxel::tasks
