// SPDX-License-Identifier: Apache-2.0
// Small campuses for tests.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/laser/laser.hpp"

namespace cluxel::test {

using namespace scan;
using namespace simulation;

/// A campus of 50 m with few points; it takes a second or less.
CampusParams smallCampus(std::uint64_t seed);

/// Without noise.
CampusParams withoutNoise(CampusParams params);

/// One stop at the origin inside a closed cube with walls at a distance of `half_m`.
Campus room(const CampusParams& params, double half_m);

std::vector<SimulatedScan> scanAll(const Campus& campus);

}  // namespace cluxel::test
