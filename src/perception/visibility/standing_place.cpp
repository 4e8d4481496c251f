// SPDX-License-Identifier: Apache-2.0
// Counts the rays along an upright line as verdicts count those near a point.
#include "perception/visibility/standing_place.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace cluxel::perception {

namespace {

constexpr double kStep_m = 0.3;  ///< twice RayParams::near_m; rays nearer to the ground end before what stands there
constexpr double kHighest_m = 30;
/// Who measured so near beside a place was looking: nothing is known of how wide a thing is.
constexpr double kMeasured_m = 0.5;
constexpr double kAlike_m = 2;  ///< rays that start so near to each other are stopped by the same things

using Bundles = std::vector<const RayBundle*>;

/// Bundles that start within `view_m` of a place, by the square in which they start.
std::vector<Bundles> startsNear(const ScanRays& rays, const StandingPlace& place, double view_m) {
  std::map<std::pair<std::int64_t, std::int64_t>, Bundles> in_square;
  const auto number = [](double at) { return static_cast<std::int64_t>(std::floor(at / kAlike_m)); };
  for (const RayBundle& bundle : rays.bundles())
    if ((bundle.origin() - place.foot).head<2>().norm() <= view_m)
      in_square[{number(bundle.origin().x()), number(bundle.origin().y())}].push_back(&bundle);
  std::vector<Bundles> starts;
  for (auto& [square, bundles] : in_square) starts.push_back(std::move(bundles));
  return starts;
}

bool lookAt(const Bundles& bundles, const std::vector<Eigen::Vector3d>& points, const RayParams& params) {
  RayParams measured = params;
  measured.near_m = kMeasured_m;
  double passed = 0, stopped = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    RaysNear here;
    for (const RayBundle* bundle : bundles) {
      if (bundle->raysNear(points[i], measured).counts.ended > 0) return true;
      const RaysNear found = bundle->raysNear(points[i], params);
      here.counts += found.counts, here.others += found.others;
    }
    if (i == 0) continue;  // on level ground most rays near the foot end before it
    passed += static_cast<double>(here.counts.passed), stopped += static_cast<double>(here.others);
    if (here.counts.passed + here.others > 0) continue;
    double missing = 0;
    for (const RayBundle* bundle : bundles) missing += bundle->returnsMissing(points[i], params);
    if (missing >= params.min_missing) passed += missing;
  }
  return passed >= params.min_rays && stopped <= passed;
}

}  // namespace

double StandingPlace::top_m() const {
  return std::clamp(height_m, kStep_m, kHighest_m);
}

std::vector<Eigen::Vector3d> pointsOf(const StandingPlace& place) {
  constexpr double kRounding_m = 1e-6;
  std::vector<Eigen::Vector3d> points;
  const int last = static_cast<int>((place.top_m() + kRounding_m) / kStep_m);
  for (int i = 0; i <= last; ++i) points.emplace_back(place.foot + i * kStep_m * Eigen::Vector3d::UnitZ());
  if (place.top_m() - last * kStep_m > 0.5 * kStep_m)
    points.emplace_back(place.foot + place.top_m() * Eigen::Vector3d::UnitZ());
  return points;
}

bool looksAt(const ScanRays& rays, const StandingPlace& place, double view_m, const RayParams& params) {
  const std::vector<Bundles> starts = startsNear(rays, place, view_m);
  const std::vector<Eigen::Vector3d> points = pointsOf(place);
  return std::any_of(starts.begin(), starts.end(),
                     [&](const Bundles& bundles) { return lookAt(bundles, points, params); });
}

}  // namespace cluxel::perception
