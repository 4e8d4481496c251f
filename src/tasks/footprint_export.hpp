// SPDX-License-Identifier: Apache-2.0
// Footprints of objects as GeoJSON.
#pragma once

#include "cluxel/tasks/map_export.hpp"

namespace cluxel {

void writeFootprints(const MapReader& map, const ByteSink& out);

}  // namespace cluxel
