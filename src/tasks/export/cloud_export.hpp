// SPDX-License-Identifier: Apache-2.0
// Clouds coloured by class.
#pragma once

#include <array>

#include "tasks/export/map_export.hpp"

namespace cluxel::tasks {

/// Red, green, blue.
using PointColour = std::array<std::uint8_t, 3>;
/// The colour of the points of a cluxel of the scene; `object` is the number of its object, or kNoObjectOfPoint.
using ColourOfPoint = std::function<PointColour(std::uint32_t cluxel, std::uint32_t object)>;

void writeColouredPly(const mapping::MapReader& map, const ColourOfPoint& colourOfPoint, const ByteSink& out);
/// In the colours of the objects' classes.
void writeColouredPly(const mapping::MapReader& map, const ByteSink& out);

}  // namespace cluxel::tasks
