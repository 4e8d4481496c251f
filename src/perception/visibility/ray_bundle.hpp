// SPDX-License-Identifier: Apache-2.0
// The rays of a scan that start at one place, indexed by direction: those near a place, and whether the sky lies
// behind.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "perception/visibility/direction_index.hpp"
#include "perception/visibility/expected_returns.hpp"
#include "perception/visibility/place.hpp"

namespace cluxel::perception {

struct RayParams {
  double near_m = 0.15;    ///< a ray concerns a place when it passes within this distance of it
  double hit_m = 0.25;     ///< a ray hits a place when it ends within this distance before or behind it
  double behind_m = 0.40;  ///< a ray sees through a place when it ends at least so far behind it
  /// So many rays must see through a place. Far from the sensor rays lie so far apart that they miss thin things.
  int min_rays = 3;
  /// Where rays return from something, so many or more do near a place. Then a place where none returns is empty.
  double min_missing = 4;
  /// Of rays, with the width of their beams (2 to 3 mrad): far from the sensor they graze the ground, and so small an
  /// error takes them over a low thing.
  double elevation_error_rad = 0.003;
};

/// Rays near a place that were not stopped before it.
struct RayCounts {
  std::uint64_t ended = 0;   ///< within RayParams::hit_m of it
  std::uint64_t passed = 0;  ///< at least RayParams::behind_m behind it

  RayCounts& operator+=(const RayCounts& other) {
    ended += other.ended, passed += other.passed;
    return *this;
  }
};

/// The rays near a place by where they end.
struct RaysNear {
  RayCounts counts;
  std::uint64_t others = 0;  ///< before the place, or so little behind it that they tell nothing
};

class RayBundle {
 public:
  /// `ends` are the ends of the rays relative to `origin_map` [m]. `rows`: see DirectionIndex. Cost: linear in the
  /// rays.
  RayBundle(const Eigen::Vector3d& origin_map, std::vector<Eigen::Vector3f> ends, int rows = DirectionIndex::kFineRows);

  const Eigen::Vector3d& origin() const { return origin_; }
  double maxRange_m() const { return max_range_m_; }
  /// The ends of the rays relative to the origin [m], sorted by direction.
  std::span<const Eigen::Vector3f> rays() const { return index_.rays(); }
  /// Whether returnsMissing() may be more than zero: fewer rays tell nothing of those that did not return.
  bool mayMissReturns() const { return index_.rays().size() >= ExpectedReturns::kFewestReturns; }
  /// None when the place is out of reach. Cost: the rays within `near_m` of the direction to the place.
  RaysNear raysNear(const Eigen::Vector3d& place_map, const RayParams& params) const;
  /// Whether a ray near a place passed it that would have ended at the thing there. Cost: as for raysNear().
  bool passesWithin(const Place& place, const RayParams& params) const;
  /// How many rays something at a place above the sensor would return (ExpectedReturns) where none ends near it: zero
  /// unless the three nearest rays below it reach as far. Else a missing return tells nothing: the scan may be thinned
  /// or cut off, or a dark thing may stand before the place. Cost: the rays below the place.
  double returnsMissing(const Eigen::Vector3d& place_map, const RayParams& params) const;

 private:
  bool isWithinReach(const Eigen::Vector3d& place, const RayParams& params) const;

  Eigen::Vector3d origin_;
  double max_range_m_ = 0;
  DirectionIndex index_;
  mutable std::once_flag is_expected_known_;
  mutable std::optional<ExpectedReturns> expected_;  ///< made when a place before the sky is asked about
};

}  // namespace cluxel::perception
