// SPDX-License-Identifier: Apache-2.0
// Cluxels of scenes for tests, made from points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "perception/segments/scene.hpp"

namespace cluxel::testing {

/// Cluxels at points, joined where they are closer than `edge_m`.
inline perception::SceneCluxels cloudOf(const std::vector<Eigen::Vector3d>& points, double edge_m) {
  perception::SceneCluxels cluxels;
  cluxels.center = points;
  cluxels.name.resize(points.size());
  cluxels.extent.assign(points.size(), Eigen::Vector3f::Constant(0.1F));
  cluxels.edge_offset.push_back(0);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    cluxels.name[i].index = i;
    cluxels.height_above_ground.push_back(static_cast<float>(points[i].z()));
    for (std::uint32_t j = 0; j < points.size(); ++j)
      if (i != j && (points[i] - points[j]).norm() <= edge_m) cluxels.edge_target.push_back(j);
    cluxels.edge_offset.push_back(static_cast<std::uint32_t>(cluxels.edge_target.size()));
  }
  return cluxels;
}

}  // namespace cluxel::testing
