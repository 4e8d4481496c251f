// SPDX-License-Identifier: Apache-2.0
// Counts the rays along an upright line as verdicts count those near a point.
#include "perception/visibility/standing_place.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

namespace cluxel::perception {

namespace {

constexpr double kStep_m = 0.3;  ///< twice RayParams::near_m; rays nearer to the ground end before what stands there
constexpr double kHighest_m = 30;
/// Who measured so near beside a place was looking: nothing is known of how wide a thing is.
constexpr double kMeasured_m = 0.5;
constexpr double kRaySquare_m = 8;       ///< longer rays than this are among those of several squares
constexpr double kRayRounding_m = 0.01;  ///< of rays, which are floats
constexpr double kAlike_m = 2;           ///< rays that start so near to each other are stopped by the same things

using Bundles = std::vector<const RayBundle*>;

/// Bundles by the square in which they start.
std::vector<Bundles> byStart(const Bundles& near, const TileGrid& grid) {
  std::map<std::pair<std::int64_t, std::int64_t>, Bundles> in_square;
  const auto number = [](double at) { return static_cast<std::int64_t>(std::floor(at / kAlike_m)); };
  for (const RayBundle* bundle : near) {
    const Eigen::Vector3d start = grid.fromMap(bundle->origin());
    in_square[{number(start.x()), number(start.y())}].push_back(bundle);
  }
  std::vector<Bundles> starts;
  for (auto& [square, bundles] : in_square) starts.push_back(std::move(bundles));
  return starts;
}

bool areLookingAt(const Bundles& bundles, const std::vector<Eigen::Vector3d>& points, const RayParams& params) {
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

LookingRays::LookingRays(const ScanRays& rays, double view_m, const TileGrid& grid, const RayParams& params)
    : view_m_(view_m),
      edge_m_(std::max(kRaySquare_m, view_m / 4)),
      beside_m_(std::max(kMeasured_m, params.near_m) + kRayRounding_m),
      grid_(grid),
      params_(params) {
  for (const RayBundle& bundle : rays.bundles()) {
    const auto number = static_cast<std::uint32_t>(bundles_.size());
    bundles_.push_back(&bundle);
    if (bundle.mayMissReturns()) {
      large_.push_back(number);
      continue;
    }
    std::set<Square> squares;
    for (const Eigen::Vector3f& ray : bundle.rays()) addSquaresOf(bundle, ray, squares);
    for (const Square& square : squares) small_beside_[square].push_back(number);
  }
}

LookingRays::Square LookingRays::squareAt(const Eigen::Vector2d& p_map) const {
  const auto number = [&](double at) { return static_cast<std::int64_t>(std::floor(at / edge_m_)); };
  return {number(p_map.x()), number(p_map.y())};
}

void LookingRays::addSquaresOf(const RayBundle& bundle, const Eigen::Vector3f& ray, std::set<Square>& squares) const {
  // A ray concerns places as far as the longest ray of its bundle reaches.
  const Eigen::Vector3d way = ray.cast<double>().normalized();
  const double reach_m = bundle.maxRange_m() + params_.hit_m, across = way.head<2>().norm();
  const double length_m = std::min(reach_m, (view_m_ + beside_m_) / std::max(across, 1e-12));
  const Eigen::Vector2d start = bundle.origin().head<2>(), end = start + length_m * way.head<2>();
  const Eigen::Vector2d around = Eigen::Vector2d::Constant(beside_m_);
  const Square low = squareAt(start.cwiseMin(end) - around), high = squareAt(start.cwiseMax(end) + around);
  for (std::int64_t x = low.first; x <= high.first; ++x)
    for (std::int64_t y = low.second; y <= high.second; ++y) {
      const Eigen::Vector2d middle =
          edge_m_ * Eigen::Vector2d(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
      const double along_m =
          std::clamp((middle - start).dot(way.head<2>()) / std::max(across * across, 1e-12), 0.0, length_m);
      if ((start + along_m * way.head<2>() - middle).norm() <= edge_m_ * std::numbers::sqrt2 / 2 + beside_m_)
        squares.emplace(x, y);
    }
}

std::vector<const RayBundle*> LookingRays::bundlesNear(const StandingPlace& place) const {
  std::vector<std::uint32_t> numbers = large_;
  if (const auto found = small_beside_.find(squareAt(place.foot.head<2>())); found != small_beside_.end()) {
    numbers.insert(numbers.end(), found->second.begin(), found->second.end());
    std::inplace_merge(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(large_.size()), numbers.end());
  }
  std::vector<const RayBundle*> near;
  for (const std::uint32_t number : numbers)
    if ((bundles_[number]->origin() - place.foot).head<2>().norm() <= view_m_) near.push_back(bundles_[number]);
  return near;
}

bool LookingRays::lookAt(const StandingPlace& place) const {
  const std::vector<Bundles> starts = byStart(bundlesNear(place), grid_);
  const std::vector<Eigen::Vector3d> points = pointsOf(place);
  return std::any_of(starts.begin(), starts.end(),
                     [&](const Bundles& bundles) { return areLookingAt(bundles, points, params_); });
}

}  // namespace cluxel::perception
