// SPDX-License-Identifier: Apache-2.0
// Cost maps in the form of ROS map_server: a grey image and a YAML file.
#pragma once

#include <cstdint>
#include <string>

#include "tasks/ways/passable_grid.hpp"
#include "tasks/ways/route.hpp"

namespace cluxel::tasks {

struct CostMap {
  std::string image;  ///< PGM (P5), the row with the largest y first: 254 free, 0 occupied, 205 unknown
  std::string yaml;   ///< names the image, its resolution and the place of its lower left corner
};

/// What a cell of a cost map is. All but Free and Unobserved are closed. Step: isBesideStep().
enum class CellKind : std::uint8_t { Free, Thing, Step, TooSteep, TooNarrow, Unobserved };
const char* nameOf(CellKind kind);  ///< "too steep"
CellKind kindOf(const PassableGrid& grid, std::uint32_t cell);

/// Whether a step that is too high lies between the cell and one beside it.
bool isBesideStep(const PassableGrid& grid, std::uint32_t cell);

/// The grid of a cost map. Its width is 0, whatever the request says: the navigation software of a robot adds that.
/// Throws as passableIn().
PassableGrid costMapGridIn(const mapping::MapReader& map, WayRequest request);

/// Occupied are cells with things, too steep ones, and both sides of a step that is too high. `image_name`: how the
/// YAML file names the image.
CostMap costMapOf(const PassableGrid& grid, const std::string& image_name);

}  // namespace cluxel::tasks
