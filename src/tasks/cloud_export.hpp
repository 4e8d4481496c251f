// SPDX-License-Identifier: Apache-2.0
// Clouds coloured by class.
#pragma once

#include "cluxel/tasks/map_export.hpp"

namespace cluxel {

void writeColouredPly(const MapReader& map, const ByteSink& out);

}  // namespace cluxel
