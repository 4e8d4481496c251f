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

/// Sorts rays by where they start.
class Starts {
 public:
  Start& at(const Eigen::Vector3d& origin) {
    if (all_.empty() || !isNear(last_, origin)) last_ = numberOf(origin);
    return all_[last_];
  }
  std::vector<Start> take() { return std::move(all_); }

 private:
  using Cell = std::array<std::int64_t, 3>;

  static Cell cellOf(const Eigen::Vector3d& p) {
    const auto number = [](double at) { return static_cast<std::int64_t>(std::floor(at / kSameOrigin_m)); };
    return {number(p.x()), number(p.y()), number(p.z())};
  }
  bool isNear(std::size_t start, const Eigen::Vector3d& origin) const {
    return (all_[start].origin - origin).norm() <= kSameOrigin_m;
  }

  /// The first start near the origin, or a new one.
  std::size_t numberOf(const Eigen::Vector3d& origin) {
    const Cell cell = cellOf(origin);
    std::size_t first = all_.size();
    for (std::int64_t x = -1; x <= 1; ++x)
      for (std::int64_t y = -1; y <= 1; ++y)
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto known = of_cell_.find({cell[0] + x, cell[1] + y, cell[2] + z});
          if (known == of_cell_.end()) continue;
          for (const std::size_t start : known->second)
            if (start < first && isNear(start, origin)) first = start;
        }
    if (first == all_.size()) {
      of_cell_[cell].push_back(first);
      all_.push_back({origin, {}});
    }
    return first;
  }

  std::vector<Start> all_;
  std::map<Cell, std::vector<std::size_t>> of_cell_;
  std::size_t last_ = 0;
};

std::vector<Start> startsOf(const scan::Scan& scan) {
  const scan::ScanPoints& points = scan.points;
  if (points.origin.empty() && !scan.has_pose) return {};
  Starts starts;
  const Eigen::Vector3d sensor = scan.T_map_sensor.translation();
  if (points.origin.empty()) starts.at(sensor).ends.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    Start& start = starts.at(points.origin.empty() ? sensor : scan::toMap(scan.T_map_sensor, points.origin[i]));
    const Eigen::Vector3d end = scan::toMap(scan.T_map_sensor, {points.x[i], points.y[i], points.z[i]}) - start.origin;
    if (end.squaredNorm() > 0) start.ends.push_back(end.cast<float>());
  }
  std::vector<Start> all = starts.take();
  std::erase_if(all, [](const Start& start) { return start.ends.empty(); });
  return all;
}

/// Coarser where there are few rays: the cells of many bundles would take more memory than the rays.
int rowsFor(std::size_t rays) {
  constexpr int kFewest = 45;
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

}  // namespace cluxel::perception
