// SPDX-License-Identifier: Apache-2.0
// The first surface that a ray meets, through Embree.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "simulation/laser/laser.hpp"

namespace cluxel::simulation {

/// Thread-safe for casting. Embree picks the triangle; range and incidence are computed here in double, so
/// they do not depend on Embree's choice of vector instructions.
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
