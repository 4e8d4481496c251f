// SPDX-License-Identifier: Apache-2.0
// Where the rays of a stored scan start: the place of its sensor, or those that a moving sensor passed.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mapping/clouds/cloud.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// The one place of the sensor [m, map]: where the ray origins of the points say, else at the pose. Absent when rays
/// start in several places (perception::kSameSensor_m), or nothing tells where.
std::optional<Eigen::Vector3d> sensorPlaceOf(const Cloud& cloud);

/// The last places of rays [m, map], the start of the last ray first, one for each square of `square_m` to the side.
/// Empty when nothing tells where rays start. The points are read where rays start in several places: some 20 ns a
/// point.
std::vector<Eigen::Vector3d> rayStartsOf(const rdf::ReadTransaction& transaction, const Cloud& cloud,
                                         double square_m = 1);

}  // namespace cluxel::mapping
