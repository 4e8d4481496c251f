// SPDX-License-Identifier: Apache-2.0
// What ways over the ground of a map may be like, and where they begin.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "cluxel/object.hpp"

namespace cluxel {

/// Where a way begins or ends: a position, or an object by its IRI, at least four leading digits of its hash, or its
/// number ("#17"). The text "X,Y" is a position, too.
using Place = std::variant<GroundPosition, std::string>;

/// What ground can be used. Numbers out of range are refused.
struct GroundOptions {
  double max_slope = 0.12;                ///< rise over run, 0 to 10
  double max_step_m = 0.06;               ///< height of a kerb that can be crossed, 0 to 2
  double clearance_m = 2;                 ///< what hangs higher above the ground is no obstacle, 0.3 to 20
  double cell_m = 0.25;                   ///< edge of a grid cell: 0.125, 0.25, 0.5 or 1
  std::vector<std::string> without = {};  ///< classes of objects to leave out, or "Movable" or "Static"
  bool with_gone = false;                 ///< objects that later scans saw through are there all the same
};

}  // namespace cluxel
