// SPDX-License-Identifier: Apache-2.0
// Whether a scan looked at a place where something may stand: nothing measured of a thing is needed.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "perception/tile.hpp"
#include "perception/visibility/scan_rays.hpp"

namespace cluxel::perception {

/// Where a thing would stand: an upright line from the ground upwards.
struct StandingPlace {
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();  ///< on the ground [m, map]
  double height_m = 1;                             ///< of the thing

  /// The top, at least 0.3 m and at most 30 m above the foot: no thing that stands is higher.
  double top_m() const;
};

/// The points of the line that rays are compared with [m, map]: the foot, then every 0.3 m up to the top, and the top
/// where it is more than 0.15 m above the last of them. So each ray that meets the line passes one within 0.15 m.
std::vector<Eigen::Vector3d> pointsOf(const StandingPlace& place);

/// The rays of a scan by the places that they may tell of. Of scans in which each point has its own origin, most rays
/// pass far from a place, and few are asked about it.
class LookingRays {
 public:
  /// Rays that start further than `view_m` from a place, across the ground, do not count. Squares in which rays start
  /// count from the corner of the grid. `rays` must outlive this. Cost: linear in the bundles.
  LookingRays(const ScanRays& rays, double view_m, const TileGrid& grid, const RayParams& params = {});

  /// Whether the rays tell what is at the place: one that passes it within half a metre ended `hit_m` before or behind
  /// it, or nearer; or `min_rays` that start in one square of 2 m passed it above the foot, and no more of those near
  /// it ended before it. A thing that stands behind a wall and looks over it is seen when more of it is seen than is
  /// hidden. Where no ray returns, those count that something there would return (RayBundle::returnsMissing). A steep
  /// ray counts at each point that it is near. Cost: for each point that of ScanRays::verdictAt() with bundlesNear().
  bool lookAt(const StandingPlace& place) const;
  /// All that may tell of the place: those of few rays where one passes it, or would if it were longer, and of the
  /// others all in view. In the order of ScanRays.
  std::vector<const RayBundle*> bundlesNear(const StandingPlace& place) const;

 private:
  using Square = std::pair<std::int64_t, std::int64_t>;
  Square squareAt(const Eigen::Vector2d& p_map) const;
  /// The squares that a ray of a bundle may tell of.
  void addSquaresOf(const RayBundle& bundle, const Eigen::Vector3f& ray, std::set<Square>& squares) const;

  double view_m_, edge_m_, beside_m_;
  TileGrid grid_;
  RayParams params_;
  std::vector<const RayBundle*> bundles_;
  std::vector<std::uint32_t> large_;                           ///< numbers of bundles with many rays, ascending
  std::map<Square, std::vector<std::uint32_t>> small_beside_;  ///< of the others, by squares beside their rays
};

}  // namespace cluxel::perception
