// SPDX-License-Identifier: Apache-2.0
// A ray is near a place when it passes it closely, or would if it were longer.
#include "perception/visibility/ray_bundle.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel::perception {

namespace {

constexpr double kMinRange_m = 0.3;  ///< of a place: nearer ones are the sensor's own carrier
constexpr std::size_t kRaysBelow = 3;

double farthestOf(const std::vector<Eigen::Vector3f>& ends) {
  double max_squared = 0;
  for (const Eigen::Vector3f& end : ends) max_squared = std::max(max_squared, end.cast<double>().squaredNorm());
  return std::sqrt(max_squared);
}

}  // namespace

RayBundle::RayBundle(const Eigen::Vector3d& origin_map, std::vector<Eigen::Vector3f> ends, int rows)
    : origin_(origin_map), max_range_m_(farthestOf(ends)), index_(std::move(ends), rows) {}

bool RayBundle::isWithinReach(const Eigen::Vector3d& place, const RayParams& params) const {
  const double distance_m = place.norm();
  return distance_m >= kMinRange_m && distance_m <= max_range_m_ + params.hit_m;
}

RaysNear RayBundle::raysNear(const Eigen::Vector3d& place_map, const RayParams& params) const {
  const Eigen::Vector3d place = place_map - origin_;
  RaysNear rays;
  if (!isWithinReach(place, params)) return rays;
  index_.forEachNear(place, params.near_m, [&](const Eigen::Vector3d&, double range_m, double along_m) {
    const bool is_hit = std::abs(range_m - along_m) <= params.hit_m, passes = range_m >= along_m + params.behind_m;
    rays.counts.ended += is_hit ? 1 : 0;
    rays.counts.passed += passes ? 1 : 0;
    rays.others += !is_hit && !passes ? 1 : 0;
  });
  return rays;
}

bool RayBundle::passesWithin(const Place& place, const RayParams& params) const {
  const Eigen::Vector3d at = place.at - origin_;
  if (!isWithinReach(at, params)) return false;
  const Silhouette thing(place, origin_, params.elevation_error_rad);
  bool is_met = false;
  index_.forEachNear(at, params.near_m, [&](const Eigen::Vector3d& end, double range_m, double along_m) {
    is_met = is_met || (range_m >= along_m + params.behind_m && thing.isMetBy(end));
  });
  return is_met;
}

double RayBundle::returnsMissing(const Eigen::Vector3d& place_map, const RayParams& params) const {
  const Eigen::Vector3d place = place_map - origin_;
  if (place.z() <= 0 || !isWithinReach(place, params)) return 0;  // below the sensor a ray without return was swallowed
  const std::vector<Eigen::Vector3f> below = index_.nearestBelow(place, params.near_m, kRaysBelow);
  const double reach_m = place.head<2>().norm() - params.hit_m;
  const auto reaches = [reach_m](const Eigen::Vector3f& end) { return end.cast<double>().head<2>().norm() >= reach_m; };
  if (below.size() < kRaysBelow || !std::all_of(below.begin(), below.end(), reaches)) return 0;
  std::call_once(is_expected_known_, [this] { expected_.emplace(index_, RayParams{}.near_m); });
  return expected_->around(place);
}

}  // namespace cluxel::perception
