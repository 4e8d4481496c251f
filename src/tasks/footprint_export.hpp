// SPDX-License-Identifier: Apache-2.0
// Footprints of objects as GeoJSON.
#pragma once

#include "tasks/map_export.hpp"

namespace cluxel::tasks {

/// Throws Error (InvalidArgument, Remedy::LocalFrame) for longitude and latitude of a map without coordinate system.
void writeFootprints(const mapping::MapReader& map, ExportFrame frame, const ByteSink& out);

}  // namespace cluxel::tasks
