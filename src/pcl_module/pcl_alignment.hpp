// SPDX-License-Identifier: Apache-2.0
// PCL's search trees and its generalised ICP, documented in PclFunctions.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "scan/registration/surface_cloud.hpp"

namespace cluxel::scan {

std::vector<SurfacePlane> planesAt(const std::vector<Eigen::Vector3f>& points, const std::vector<std::size_t>& chosen);

std::optional<Eigen::Isometry3d> alignedByGicp(const SurfaceCloud& target, const SurfaceCloud& source,
                                               const Eigen::Isometry3d& T_target_source, double reach_m);

}  // namespace cluxel::scan
