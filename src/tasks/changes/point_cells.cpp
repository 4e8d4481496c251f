// SPDX-License-Identifier: Apache-2.0
// Scans are read twice: once for their points and once, when all cells are known, for their rays.
#include "tasks/changes/point_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "base/parallel.hpp"
#include "mapping/presence/ray_pass.hpp"

namespace cluxel::tasks {

namespace {

using perception::RayVerdict;
using BlockKey = std::uint64_t;

constexpr double kCell_m = 0.1, kNear_m = 0.25;
constexpr std::size_t kBefore = 0, kAfter = 1;
constexpr std::uint32_t kMuchMore = 3;  ///< times the points of the other time

/// Narrower than for cluxels, but wider than the errors of poses. ExpectedReturns counts rays within 0.15 m of a place:
/// eight of them there are some four within 0.10 m.
constexpr perception::RayParams kRayParams{
    .near_m = 0.10, .hit_m = 0.15, .behind_m = 0.30, .min_rays = 3, .min_missing = 8};

/// 21 bits an axis: blocks that share a key lie some 200 km apart.
BlockKey keyOf(const Eigen::Vector3d& p, double edge_m) {
  constexpr int kBits = 21;
  BlockKey key = 0;
  for (const double coordinate : p) {
    const auto number = static_cast<std::int64_t>(std::floor(coordinate / edge_m));
    key = key << kBits | (static_cast<BlockKey>(number) & ((BlockKey{1} << kBits) - 1));
  }
  return key;
}

/// The points of each time in a cell.
struct PointSums {
  std::array<Eigen::Vector3d, 2> sum{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  std::array<std::uint32_t, 2> count{}, cluxel{};
  std::array<std::uint64_t, 2> scans{};
};

/// A timed scan.
struct TimedScan {
  const mapping::Cloud& cloud;
  std::size_t time;   ///< kBefore or kAfter
  std::uint64_t bit;  ///< of RayLooks
};

class Cells {
 public:
  Cells(const mapping::MapReader& map, double since_s, unsigned threads)
      : map_(map), clouds_(map.clouds()), threads_(threads) {
    for (const mapping::Cloud* cloud : mapping::timedClouds(clouds_))
      scans_.push_back(
          {*cloud, *cloud->time_s < since_s ? kBefore : kAfter, std::uint64_t{1} << (scans_.size() % kScanBits)});
  }

  PointCells run(const std::vector<bool>& wanted) {
    collect(wanted);
    for (const TimedScan& scan : scans_)
      perception::forEachRayBundle(map_.scanOf(scan.cloud.id), [&](const perception::RayBundle& bundle) {
        for (const std::size_t time : {kBefore, kAfter}) look(bundle, scan, time);
      });
    for (auto& cells : cells_)
      for (PointCell& cell : cells)
        for (RayLooks* looks : {&cell.own, &cell.other}) looks->through_scans &= ~looks->hit_scans;
    return {std::move(cells_[kBefore]), std::move(cells_[kAfter])};
  }

 private:
  void collect(const std::vector<bool>& wanted) {
    std::unordered_map<BlockKey, PointSums> sums;
    for (const TimedScan& scan : scans_) addPoints(scan, wanted, sums);
    std::vector<std::pair<BlockKey, PointSums>> sorted(sums.begin(), sums.end());
    std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [key, cell] : sorted)
      for (const std::size_t time : {kBefore, kAfter}) addCell(cell, time);
  }

  void addPoints(const TimedScan& scan, const std::vector<bool>& wanted,
                 std::unordered_map<BlockKey, PointSums>& sums) const {
    const scan::ScanPoints points = map_.pointsOf(scan.cloud.id);
    const std::vector<std::uint32_t> cluxel = map_.answersFor(scan.cloud).cluxel;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!wanted[cluxel[i]]) continue;
      const Eigen::Vector3d p_map = scan::toMap(scan.cloud.T_map_sensor, {points.x[i], points.y[i], points.z[i]});
      PointSums& cell = sums[keyOf(p_map, kCell_m)];
      if (cell.count[scan.time] == 0) cell.cluxel[scan.time] = cluxel[i];
      cell.sum[scan.time] += p_map;
      ++cell.count[scan.time];
      cell.scans[scan.time] |= scan.bit;
    }
  }

  void addCell(const PointSums& cell, std::size_t time) {
    const std::uint32_t count = cell.count[time];
    if (count == 0) return;
    const bool is_shared = kMuchMore * cell.count[1 - time] > count;
    cells_[time].push_back({cell.sum[time] / count, cell.cluxel[time], cell.scans[time], is_shared, {}, {}});
  }

  void look(const perception::RayBundle& bundle, const TimedScan& scan, std::size_t time) {
    constexpr std::size_t kChunk = 2048;
    std::vector<PointCell>& cells = cells_[time];
    parallelFor((cells.size() + kChunk - 1) / kChunk, threads_, [&](std::size_t chunk) {
      const std::size_t end = std::min(cells.size(), (chunk + 1) * kChunk);
      for (std::size_t i = chunk * kChunk; i < end; ++i) {
        if (cells[i].is_shared) continue;
        const perception::PlaceVerdict found = bundle.verdictAt(cells[i].place, kRayParams);
        RayLooks& looks = scan.time == time ? cells[i].own : cells[i].other;
        looks.rays += found.rays;
        if (found.verdict == RayVerdict::Hit) looks.hit_scans |= scan.bit;
        if (found.verdict == RayVerdict::SeenThrough || found.verdict == RayVerdict::FewPassed)
          looks.through_scans |= scan.bit;
      }
    });
  }

  const mapping::MapReader& map_;
  std::vector<mapping::Cloud> clouds_;
  unsigned threads_;
  std::vector<TimedScan> scans_;
  std::array<std::vector<PointCell>, 2> cells_;  ///< before and after
};

}  // namespace

PointCells pointCellsOf(const mapping::MapReader& map, double since_s, const std::vector<bool>& wanted,
                        unsigned threads) {
  return Cells(map, since_s, threads).run(wanted);
}

CellNeighbours::CellNeighbours(const std::vector<PointCell>& cells) : cells_(cells) {
  for (std::uint32_t i = 0; i < cells.size(); ++i) by_block_.emplace_back(keyOf(cells[i].place, kNear_m), i);
  std::sort(by_block_.begin(), by_block_.end());
}

void CellNeighbours::forEach(std::uint32_t cell, const std::function<void(std::uint32_t)>& visit) const {
  const Eigen::Vector3d& place = cells_[cell].place;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        const BlockKey block = keyOf(place + kNear_m * Eigen::Vector3d(x, y, z), kNear_m);
        auto at = std::lower_bound(by_block_.begin(), by_block_.end(), std::pair(block, std::uint32_t{0}));
        for (; at != by_block_.end() && at->first == block; ++at)
          if ((cells_[at->second].place - place).squaredNorm() <= kNear_m * kNear_m) visit(at->second);
      }
}

}  // namespace cluxel::tasks
