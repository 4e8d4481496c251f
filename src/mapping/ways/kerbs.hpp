// SPDX-License-Identifier: Apache-2.0
// Kerbs: steps at the edges of even ground.
#pragma once

#include <vector>

#include "mapping/ways/even_ground.hpp"

namespace cluxel::mapping {

inline constexpr int kKerbLevels = 8;  ///< of skeletonOf(): a kerb is not wider than twice as many cells

/// The step at each cell that lies on a kerb [m], else 0. It lies where even ground ends and the measured ground half a
/// metre farther lies 8 to 25 cm higher or lower, and both sides are level within half of that: a bank rises slowly. A
/// cell's step follows from the cells within 4.
std::vector<float> kerbSteps(const GroundCells& ground);

}  // namespace cluxel::mapping
