// SPDX-License-Identifier: Apache-2.0
// The first surface that a ray meets, through Embree.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "simulation/laser/laser.hpp"

namespace cluxel::simulation {

/// Thread-safe for casting. Embree finds the triangles that a ray meets; which is the nearest, its range and its
/// incidence are computed here in double, so that they do not depend on the processor. Of equal ranges the first
/// triangle of the first mesh counts.
class RayCaster {
 public:
  explicit RayCaster(const Campus& campus);
  ~RayCaster();

  std::optional<RayHit> cast(const Eigen::Vector3d& origin_map, const Eigen::Vector3d& direction_map,
                             double max_range_m) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
  const Campus& campus_;
};

}  // namespace cluxel::simulation
