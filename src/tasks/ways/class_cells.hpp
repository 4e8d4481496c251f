// SPDX-License-Identifier: Apache-2.0
// Where on the ground something of a class is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tasks/ways/terrain_grid.hpp"

namespace cluxel::tasks {

/// The cells that hold something of a class: cells in which such an object stands, the
/// positions of things that SPARQL rules derive, and cells along the lines of ways. `is_left_out`: per object, true
/// where it does not count.
LargeArray<std::uint8_t> cellsWith(const mapping::MapReader& map, const TerrainGrid& terrain,
                                   const std::string& class_iri, const std::vector<bool>& is_left_out);
/// The same where it is known which objects are of the class, as objectsOfClass() tells.
LargeArray<std::uint8_t> cellsWith(const mapping::MapReader& map, const TerrainGrid& terrain,
                                   const std::string& class_iri, const std::vector<bool>& is_of_class,
                                   const std::vector<bool>& is_left_out);

}  // namespace cluxel::tasks
