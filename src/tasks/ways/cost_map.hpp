// SPDX-License-Identifier: Apache-2.0
// Cost maps in the form of ROS map_server: a grey image and a YAML file.
#pragma once

#include <string>

#include "tasks/ways/passable_grid.hpp"

namespace cluxel::tasks {

struct CostMap {
  std::string image;  ///< PGM (P5), the row with the largest y first: 254 free, 0 occupied, 205 unknown
  std::string yaml;   ///< names the image, its resolution and the place of its lower left corner
};

/// Whether a step that is too high lies between the cell and one beside it.
bool isBesideStep(const PassableGrid& grid, std::uint32_t cell);

/// Occupied are cells with things, too steep ones, and both sides of a step that is too high. `image_name`: how the
/// YAML file names the image.
CostMap costMapOf(const PassableGrid& grid, const std::string& image_name);

}  // namespace cluxel::tasks
