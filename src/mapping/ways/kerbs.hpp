// SPDX-License-Identifier: Apache-2.0
// Kerbs: steps at the edges of even ground.
#pragma once

#include <vector>

#include "mapping/ways/even_ground.hpp"
#include "mapping/ways/ways.hpp"

namespace cluxel::mapping {

/// Where even ground ends and the measured ground half a metre farther lies 8 to 25 cm higher or lower, and both sides
/// are level within half of that: a bank rises slowly. Lines of such cells of at least kLeastKerb_m.
std::vector<Kerb> kerbsOf(const GroundCells& ground);

}  // namespace cluxel::mapping
