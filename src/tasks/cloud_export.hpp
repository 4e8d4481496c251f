// SPDX-License-Identifier: Apache-2.0
// Clouds coloured by class.
#pragma once

#include "tasks/map_export.hpp"

namespace cluxel::tasks {

void writeColouredPly(const mapping::MapReader& map, const ByteSink& out);

}  // namespace cluxel::tasks
