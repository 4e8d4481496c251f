// SPDX-License-Identifier: Apache-2.0
// The rays of one scan. They tell whether a place was hit, seen through or hidden.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>

#include "perception/visibility/ray_bundle.hpp"
#include "scan/scan.hpp"

namespace cluxel::perception {

/// What the rays near a place say about it.
enum class RayVerdict : std::uint8_t {
  NotCovered,   ///< no ray came near, or most that did ended before it: it lies at the edge of what hides it
  Hit,          ///< some ray ended there
  SeenThrough,  ///< several rays passed it and ended behind it, or into the sky; none ended there
  FewPassed,    ///< fewer did: not enough to tell that a thin thing is not there
};

struct PlaceVerdict {
  RayVerdict verdict = RayVerdict::NotCovered;
  bool is_sparse = false;     ///< fewer than RayParams::min_rays came near and were not stopped before
  RayCounts rays{};           ///< near the place
  std::uint64_t stopped = 0;  ///< rays near it that ended before it, or so little behind it that they tell nothing
  /// Rays passed, but none of them would have ended at the thing (Silhouette): rays far apart pass a thin pole on both
  /// sides, and many pass close above a roof.
  bool is_aside = false;
};

/// The rays of a scan, one bundle for each place of the sensor, in whatever order the points are. Rays that start
/// within 5 cm of each other are taken to start at one place. Empty for a scan without origins: one without pose and
/// without an origin per point.
class ScanRays {
 public:
  /// Cost: linear in the points when they have no origins of their own, else n log n.
  explicit ScanRays(const scan::Scan& scan);

  bool empty() const { return bundles_.empty(); }
  /// Ascending by x, y, z of their origins.
  const std::deque<RayBundle>& bundles() const { return bundles_; }
  /// Whether a ray may concern a place within a sphere.
  bool mayConcern(const Eigen::Vector3d& centre_map, double radius_m, const RayParams& params) const;
  /// Cost of this and of verdictAt(): for each bundle the rays within `near_m` of the direction to the place, and for
  /// places before the sky those below it.
  RayCounts countsAt(const Eigen::Vector3d& place_map, const RayParams& params) const;
  /// A place above the sensor where no ray ends or passes is seen through when something there would return
  /// `min_missing` rays (RayBundle::returnsMissing).
  PlaceVerdict verdictAt(const Eigen::Vector3d& place_map, const RayParams& params) const;
  /// The same, and whether the rays tell of the thing there. Cost: twice that where rays pass.
  PlaceVerdict verdictAt(const Place& place, const RayParams& params) const;

 private:
  /// Whether so many returns are missing that rays would have ended at the thing, however thin it is there.
  bool isMissed(const Place& place, const RayParams& params) const;

  std::deque<RayBundle> bundles_;
};

}  // namespace cluxel::perception
