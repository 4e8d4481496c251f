// SPDX-License-Identifier: Apache-2.0
// Rays that return from the place or from behind it tell first; where none does, the directions that should have
// returned do.
#include "perception/visibility/ray_bundle.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel::perception {

namespace {

constexpr double kSameOrigin_m = 0.05;
constexpr double kMinRange_m = 0.3;  ///< of a place: nearer ones are the sensor's own carrier
constexpr std::size_t kRaysBelow = 3;

double farthestOf(const std::vector<Eigen::Vector3f>& ends) {
  double max_squared = 0;
  for (const Eigen::Vector3f& end : ends) max_squared = std::max(max_squared, end.cast<double>().squaredNorm());
  return std::sqrt(max_squared);
}

}  // namespace

RayBundle::RayBundle(const Eigen::Vector3d& origin_map, std::vector<Eigen::Vector3f> ends)
    : origin_(origin_map), max_range_m_(farthestOf(ends)), index_(std::move(ends)) {}

RayCounts RayBundle::countsAt(const Eigen::Vector3d& place_map, const RayParams& params) const {
  const Eigen::Vector3d place = place_map - origin_;
  const double distance_m = place.norm();
  if (distance_m < kMinRange_m || distance_m > max_range_m_ + params.hit_m) return {};
  RayCounts counts;
  index_.forEachNear(place, params.near_m, [&](double range_m, double along_m) {
    counts.ended += std::abs(range_m - along_m) <= params.hit_m ? 1 : 0;
    counts.passed += range_m >= along_m + params.behind_m ? 1 : 0;
  });
  return counts;
}

PlaceVerdict RayBundle::verdictAt(const Eigen::Vector3d& place_map, const RayParams& params) const {
  const Eigen::Vector3d place = place_map - origin_;
  const double distance_m = place.norm();
  if (distance_m < kMinRange_m || distance_m > max_range_m_ + params.hit_m) return {};
  RayCounts rays;
  std::uint64_t others = 0;
  index_.forEachNear(place, params.near_m, [&](double range_m, double along_m) {
    const bool is_hit = std::abs(range_m - along_m) <= params.hit_m, passes = range_m >= along_m + params.behind_m;
    rays.ended += is_hit ? 1 : 0;
    rays.passed += passes ? 1 : 0;
    others += !is_hit && !passes ? 1 : 0;
  });
  const auto min_rays = static_cast<std::uint64_t>(params.min_rays);
  if (rays.ended > 0) return {RayVerdict::Hit, rays.ended + rays.passed < min_rays, rays};
  if (rays.passed > 0 && others > rays.passed) return {RayVerdict::NotCovered, false, rays};
  if (rays.passed >= min_rays) return {RayVerdict::SeenThrough, false, rays};
  if (others == 0 && isBeforeSky(place, params)) return {RayVerdict::SeenThrough, false, rays};
  if (rays.passed == 0) return {};
  return {RayVerdict::FewPassed, true, rays};
}

bool RayBundle::isBeforeSky(const Eigen::Vector3d& place, const RayParams& params) const {
  if (place.z() <= 0) return false;  // below the sensor a ray without return was swallowed
  const std::vector<Eigen::Vector3f> below = index_.nearestBelow(place, params.near_m, kRaysBelow);
  const double reach_m = place.head<2>().norm() - params.hit_m;
  const auto reaches = [reach_m](const Eigen::Vector3f& end) { return end.cast<double>().head<2>().norm() >= reach_m; };
  if (below.size() < kRaysBelow || !std::all_of(below.begin(), below.end(), reaches)) return false;
  std::call_once(is_expected_known_, [this] { expected_.emplace(index_, RayParams{}.near_m); });
  return expected_->around(place) >= params.min_missing;
}

void forEachRayBundle(const scan::Scan& scan, const std::function<void(const RayBundle&)>& visit) {
  const scan::ScanPoints& points = scan.points;
  if (points.origin.empty() && !scan.has_pose) return;
  Eigen::Vector3d origin = scan.T_map_sensor.translation();
  std::vector<Eigen::Vector3f> ends;
  if (points.origin.empty()) ends.reserve(points.size());
  const auto close = [&] {
    if (!ends.empty()) visit(RayBundle(origin, std::move(ends)));
    ends = {};
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points.origin.empty()) {
      const Eigen::Vector3d own = scan::toMap(scan.T_map_sensor, points.origin[i]);
      if ((own - origin).norm() > kSameOrigin_m) close();
      if (ends.empty()) origin = own;
    }
    const Eigen::Vector3d end = scan::toMap(scan.T_map_sensor, {points.x[i], points.y[i], points.z[i]}) - origin;
    if (end.squaredNorm() > 0) ends.push_back(end.cast<float>());
  }
  close();
}

}  // namespace cluxel::perception
