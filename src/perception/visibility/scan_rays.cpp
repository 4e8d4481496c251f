// SPDX-License-Identifier: Apache-2.0
// Rays that return from the place or from behind it tell first; where none does, the directions that should have
// returned do.
#include "perception/visibility/scan_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace cluxel::perception {

namespace {

constexpr double kSameOrigin_m = 0.05;

/// Rays that start at one place.
struct Start {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< [m, map]
  std::vector<Eigen::Vector3f> ends;                 ///< relative to it [m]
};

using Origins = std::vector<Eigen::Vector3d>;

bool isBefore(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

/// Where rays start, each once, ascending: what follows from them does not depend on the order of the points.
Origins distinct(Origins origins) {
  std::sort(origins.begin(), origins.end(), isBefore);
  origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
  return origins;
}

/// For each of the distinct origins the number of the start that it is taken for: the first one within 5 cm.
class Starts {
 public:
  explicit Starts(const Origins& distinct_origins) {
    for (const Eigen::Vector3d& origin : distinct_origins) number_.push_back(numberOf(origin));
  }
  const Origins& all() const { return all_; }
  std::size_t of(std::size_t distinct_origin) const { return number_[distinct_origin]; }

 private:
  using Cell = std::array<std::int64_t, 3>;

  static Cell cellOf(const Eigen::Vector3d& p) {
    const auto number = [](double at) { return static_cast<std::int64_t>(std::floor(at / kSameOrigin_m)); };
    return {number(p.x()), number(p.y()), number(p.z())};
  }

  std::size_t numberOf(const Eigen::Vector3d& origin) {
    const Cell cell = cellOf(origin);
    std::size_t first = all_.size();
    for (std::int64_t x = -1; x <= 1; ++x)
      for (std::int64_t y = -1; y <= 1; ++y)
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto known = of_cell_.find({cell[0] + x, cell[1] + y, cell[2] + z});
          if (known == of_cell_.end()) continue;
          for (const std::size_t start : known->second)
            if ((all_[start] - origin).norm() <= kSameOrigin_m) first = std::min(first, start);
        }
    if (first == all_.size()) {
      of_cell_[cell].push_back(first);
      all_.push_back(origin);
    }
    return first;
  }

  Origins all_;
  std::map<Cell, std::vector<std::size_t>> of_cell_;
  std::vector<std::size_t> number_;
};

std::vector<Start> startsOf(const scan::Scan& scan) {
  const scan::ScanPoints& points = scan.points;
  if (points.origin.empty() && !scan.has_pose) return {};
  Origins origins;
  for (const Eigen::Vector3f& origin : points.origin) origins.push_back(scan::toMap(scan.T_map_sensor, origin));
  if (origins.empty()) origins.emplace_back(scan.T_map_sensor.translation());
  const Origins sorted = distinct(origins);
  const Starts starts(sorted);
  std::vector<Start> all;
  for (const Eigen::Vector3d& origin : starts.all()) all.push_back({origin, {}});
  if (all.size() == 1) all.front().ends.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d& origin = origins[points.origin.empty() ? 0 : i];
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), origin, isBefore) - sorted.begin();
    Start& start = all[starts.of(static_cast<std::size_t>(at))];
    const Eigen::Vector3d end = scan::toMap(scan.T_map_sensor, {points.x[i], points.y[i], points.z[i]}) - start.origin;
    if (end.squaredNorm() > 0) start.ends.push_back(end.cast<float>());
  }
  std::erase_if(all, [](const Start& start) { return start.ends.empty(); });
  return all;
}

/// Coarser where there are few rays: the cells of many bundles would take more memory than the rays.
int rowsFor(std::size_t rays) {
  constexpr int kFewest = 8;
  constexpr std::size_t kCellsOfRay = 8;
  int rows = DirectionIndex::kFineRows;
  while (rows > kFewest && 2 * static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows) > kCellsOfRay * rays)
    rows /= 2;
  return rows;
}

}  // namespace

ScanRays::ScanRays(const scan::Scan& scan) {
  std::vector<Start> starts = startsOf(scan);
  for (Start& start : starts) {
    const int rows = starts.size() == 1 ? DirectionIndex::kFineRows : rowsFor(start.ends.size());
    bundles_.emplace_back(start.origin, std::move(start.ends), rows);
  }
}

bool ScanRays::mayConcern(const Eigen::Vector3d& centre_map, double radius_m, const RayParams& params) const {
  return std::any_of(bundles_.begin(), bundles_.end(), [&](const RayBundle& bundle) {
    return (centre_map - bundle.origin()).norm() <= bundle.maxRange_m() + radius_m + params.hit_m;
  });
}

RayCounts ScanRays::countsAt(const Eigen::Vector3d& place_map, const RayParams& params) const {
  RayCounts counts;
  for (const RayBundle& bundle : bundles_) counts += bundle.raysNear(place_map, params).counts;
  return counts;
}

PlaceVerdict ScanRays::verdictAt(const Eigen::Vector3d& place_map, const RayParams& params) const {
  RayCounts rays;
  std::uint64_t others = 0;
  for (const RayBundle& bundle : bundles_) {
    const RaysNear near = bundle.raysNear(place_map, params);
    rays += near.counts, others += near.others;
  }
  const auto min_rays = static_cast<std::uint64_t>(params.min_rays);
  if (rays.ended > 0) return {RayVerdict::Hit, rays.ended + rays.passed < min_rays, rays, others};
  if (rays.passed > 0 && others > rays.passed) return {RayVerdict::NotCovered, false, rays, others};
  if (rays.passed >= min_rays) return {RayVerdict::SeenThrough, false, rays, others};
  if (others == 0) {
    double missing = 0;
    for (const RayBundle& bundle : bundles_) missing += bundle.returnsMissing(place_map, params);
    if (missing >= params.min_missing) return {RayVerdict::SeenThrough, false, rays, 0};
  }
  if (rays.passed == 0) return {};
  return {RayVerdict::FewPassed, true, rays, others};
}

PlaceVerdict ScanRays::verdictAt(const Place& place, const RayParams& params) const {
  PlaceVerdict found = verdictAt(place.at, params);
  if (found.verdict != RayVerdict::SeenThrough && found.verdict != RayVerdict::FewPassed) return found;
  const auto is_met = [&](const RayBundle& bundle) { return bundle.passesWithin(place, params); };
  const bool is_before_sky =
      found.verdict == RayVerdict::SeenThrough && found.rays.passed < static_cast<std::uint64_t>(params.min_rays);
  found.is_aside =
      std::none_of(bundles_.begin(), bundles_.end(), is_met) && !(is_before_sky && isMissed(place, params));
  return found;
}

bool ScanRays::isMissed(const Place& place, const RayParams& params) const {
  double missing = 0;
  for (const RayBundle& bundle : bundles_) {
    const double around = bundle.returnsMissing(place.at, params);
    if (around == 0) continue;
    const double share = std::min(Silhouette(place, bundle.origin(), 0).halfWidth_m() / params.near_m, 1.0);
    missing += around * share * share;
  }
  return missing >= params.min_missing;
}

}  // namespace cluxel::perception
