// SPDX-License-Identifier: Apache-2.0
// A pan-tilt laser on the campus: ray casting by Embree, and the errors of a real range finder.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "scan/scan.hpp"
#include "scan/truth/truth.hpp"
#include "simulation/site/campus.hpp"

namespace cluxel::simulation {

/// Where a ray first meets a surface, without noise.
struct RayHit {
  double range_m = 0;
  double cos_incidence = 1;  ///< between ray and surface normal, in [0, 1]
  std::uint32_t mesh = 0;    ///< number in Campus::meshes
  std::uint32_t triangle = 0;
};

struct SimulatedScan {
  scan::Scan scan;  ///< with labels (SurfaceLabel), intensity, time, pose and id
  scan::PointTruth truth;
};

/// When the scan of a stop is taken: a minute after the one before, and visits a day after each other [s since 1970].
inline double stopTime_s(std::size_t stop, std::size_t visit = 0) {
  return 1.7e9 + 86400.0 * static_cast<double>(visit) + 60.0 * static_cast<double>(stop);
}

/// Casts rays at a campus, which must outlive it. All methods are thread-safe, and their results are independent of the
/// number of threads: the noise of a ray depends only on the seed, the stop and the number of the ray.
class Laser {
 public:
  explicit Laser(const Campus& campus);
  ~Laser();
  Laser(Laser&&) noexcept;

  /// `direction_map` has length 1. Absent: nothing within max_range_m.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin_map, const Eigen::Vector3d& direction_map) const;

  /// Whether rays of a sensor with this pose may go there by their elevation and range.
  bool reaches(const Eigen::Isometry3d& T_map_sensor, const Eigen::Vector3d& place_map) const;

  /// The angle between neighbouring rays of the scan at a stop, the same in both directions on average. Cost: that of
  /// 6000 rays.
  double meanStep_rad(std::size_t stop) const;

  /// One full turn at a stop: elevations from -50 to 55 degrees, with equal angular steps in pan and tilt,
  /// chosen from a coarse preview turn so that about points_per_stop rays return. Throws Error (InvalidArgument) for a
  /// stop that is not there.
  SimulatedScan scanAt(std::size_t stop) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cluxel::simulation
