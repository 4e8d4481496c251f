// SPDX-License-Identifier: Apache-2.0
// Counts the rays along an upright line as verdicts count those near a point.
#include "perception/visibility/standing_place.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace cluxel::perception {

namespace {

constexpr double kStep_m = 0.3;  ///< twice RayParams::near_m; rays nearer to the ground end before what stands there
constexpr double kHighest_m = 30;
constexpr double kMeasured_m = 0.5;  ///< who measured so near was looking: nothing is known of how wide a thing is

}  // namespace

double StandingPlace::top_m() const {
  return std::clamp(height_m, kStep_m, kHighest_m);
}

std::vector<Eigen::Vector3d> pointsOf(const StandingPlace& place) {
  constexpr double kRounding_m = 1e-6;
  std::vector<Eigen::Vector3d> points;
  const int last = static_cast<int>((place.top_m() + kRounding_m) / kStep_m);
  for (int i = 0; i <= last; ++i) points.emplace_back(place.foot + i * kStep_m * Eigen::Vector3d::UnitZ());
  return points;
}

bool looksAt(const ScanRays& rays, const StandingPlace& place, double view_m, const RayParams& params) {
  std::vector<const RayBundle*> near;
  for (const RayBundle& bundle : rays.bundles())
    if ((bundle.origin() - place.foot).head<2>().norm() <= view_m) near.push_back(&bundle);
  if (near.empty()) return false;
  RayParams measured = params;
  measured.near_m = measured.hit_m = kMeasured_m;
  const std::vector<Eigen::Vector3d> points = pointsOf(place);
  double passed = 0, stopped = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    RaysNear here;
    for (const RayBundle* bundle : near) {
      if (bundle->raysNear(points[i], measured).counts.ended > 0) return true;
      const RaysNear found = bundle->raysNear(points[i], params);
      here.counts += found.counts, here.others += found.others;
    }
    if (i == 0) continue;  // on level ground most rays near the foot end before it
    passed += static_cast<double>(here.counts.passed), stopped += static_cast<double>(here.others);
    if (here.counts.passed + here.others > 0) continue;
    double missing = 0;
    for (const RayBundle* bundle : near) missing += bundle->returnsMissing(points[i], params);
    if (missing >= params.min_missing) passed += missing;
  }
  return passed >= params.min_rays && stopped <= passed;
}

}  // namespace cluxel::perception
