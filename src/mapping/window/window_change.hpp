// SPDX-License-Identifier: Apache-2.0
// What a change did to the primitives of a window.
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <set>
#include <vector>

#include "mapping/window/map_window.hpp"

namespace cluxel::mapping {

struct WindowChange {
  std::vector<char> is_dirty;  ///< by primitive: something that reasoning reads of it is new
  std::vector<char> is_open;   ///< by primitive: the window does not hold all that its decisions may read
  std::set<ContentHash> gone;  ///< primitives of before that are not there any more
  std::vector<Eigen::AlignedBox2d> gone_boxes;  ///< where they were [m, map]
};

/// `anew`: changed tiles in which every primitive counts as dirty. `reach_m`: how far decisions look. `input_of` is
/// called only for primitives whose hashed inputs all lie in the window. So a larger window gives the same hash.
WindowChange changeIn(const MapWindow& window, const OutputChanges& changes, const perception::TileSet& anew,
                      double reach_m, const InputOf& input_of);

}  // namespace cluxel::mapping
