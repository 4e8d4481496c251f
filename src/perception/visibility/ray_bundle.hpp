// SPDX-License-Identifier: Apache-2.0
// The rays of a scan that start at one place, indexed by direction. They tell whether a place was hit, seen through or
// hidden.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "perception/visibility/direction_index.hpp"
#include "perception/visibility/expected_returns.hpp"
#include "scan/scan.hpp"

namespace cluxel::perception {

/// What the rays near a place say about it.
enum class RayVerdict : std::uint8_t {
  NotCovered,   ///< no ray came near, or most that did ended before it: it lies at the edge of what hides it
  Hit,          ///< some ray ended there
  SeenThrough,  ///< several rays passed it and ended behind it, or into the sky; none ended there
  FewPassed,    ///< fewer did: not enough to tell that a thin thing is not there
};

struct RayParams {
  double near_m = 0.15;    ///< a ray concerns a place when it passes within this distance of it
  double hit_m = 0.25;     ///< a ray hits a place when it ends within this distance before or behind it
  double behind_m = 0.40;  ///< a ray sees through a place when it ends at least so far behind it
  /// So many rays must see through a place. Far from the sensor rays lie so far apart that they miss thin things.
  int min_rays = 3;
  /// Where rays return from something, so many or more do near a place. Then a place where none returns is empty.
  double min_missing = 4;
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

struct PlaceVerdict {
  RayVerdict verdict = RayVerdict::NotCovered;
  bool is_sparse = false;  ///< fewer than RayParams::min_rays came near and were not stopped before
  RayCounts rays{};        ///< near the place
};

class RayBundle {
 public:
  /// `ends` are the ends of the rays relative to `origin_map` [m]. Cost: linear in the rays.
  RayBundle(const Eigen::Vector3d& origin_map, std::vector<Eigen::Vector3f> ends);

  const Eigen::Vector3d& origin() const { return origin_; }
  double maxRange_m() const { return max_range_m_; }
  /// Cost: the rays within `near_m` of the direction to the place.
  RayCounts countsAt(const Eigen::Vector3d& place_map, const RayParams& params) const;
  /// A place above the sensor where no ray ends or passes is seen through when something there would return
  /// `min_missing` rays (ExpectedReturns), and the three nearest rays below it reach as far. Else a missing return
  /// tells nothing: the scan may be thinned or cut off, or a dark thing may stand before the place. Cost: the rays
  /// within `near_m` of the direction to the place, and for places before the sky those below it.
  PlaceVerdict verdictAt(const Eigen::Vector3d& place_map, const RayParams& params) const;

 private:
  /// Whether rays went by the place and into the sky, if no ray ended near it.
  bool isBeforeSky(const Eigen::Vector3d& place, const RayParams& params) const;

  Eigen::Vector3d origin_;
  double max_range_m_ = 0;
  DirectionIndex index_;
  mutable std::once_flag is_expected_known_;
  mutable std::optional<ExpectedReturns> expected_;  ///< made when a place before the sky is asked about
};

/// Visits the rays of a scan, one bundle for each place of the sensor. Consecutive rays whose own origins lie within
/// 5 cm of the bundle's first are taken to start there. Visits nothing for a scan without origins: one without pose and
/// without an origin per point.
void forEachRayBundle(const scan::Scan& scan, const std::function<void(const RayBundle&)>& visit);

}  // namespace cluxel::perception
