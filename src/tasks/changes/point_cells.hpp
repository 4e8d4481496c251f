// SPDX-License-Identifier: Apache-2.0
// The points before and after a time in cells of a decimetre, and what the rays of both times found there.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

#include "mapping/map_reader.hpp"
#include "perception/visibility/ray_bundle.hpp"
#include "tasks/changes/changed_cluxels.hpp"

namespace cluxel::tasks {

/// What the rays of some scans found at a place. Scans are bits (kScanBits).
struct RayLooks {
  std::uint64_t hit_scans = 0;      ///< scans of which a ray ended there
  std::uint64_t through_scans = 0;  ///< scans of which rays passed, and none ended there
  perception::RayCounts rays{};

  int hits() const { return std::popcount(hit_scans); }
  int through() const { return std::popcount(through_scans); }
};

/// A cell in which scans of one time measured points.
struct PointCell {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< the mean of these points [m, map]
  std::uint32_t cluxel = 0;                         ///< of the first of them
  std::uint64_t scans = 0;                          ///< that measured them, as bits like those of RayLooks
  /// The other time measured more than a third as many points in the cell. No rays are looked at then.
  bool is_shared = false;
  RayLooks own{}, other{};  ///< of the scans of that time, and of the other time
};

/// The cells with points before and after a time, by place.
struct PointCells {
  std::vector<PointCell> before, after;
};

/// The cells of the points on `wanted` cluxels, by number in the scene, in the timed scans before `since_s` and in
/// those from it on. Cost: the points of the timed scans, and the cells times the scans within their range. Memory:
/// some 300 bytes a cell.
PointCells pointCellsOf(const mapping::MapReader& map, double since_s, const std::vector<bool>& wanted,
                        unsigned threads);

/// Finds the cells within 0.25 m of a cell. Refers to the cells.
class CellNeighbours {
 public:
  explicit CellNeighbours(const std::vector<PointCell>& cells);
  /// Visits each cell near a cell by number, and the cell itself.
  void forEach(std::uint32_t cell, const std::function<void(std::uint32_t)>& visit) const;

 private:
  const std::vector<PointCell>& cells_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> by_block_;  ///< sorted
};

}  // namespace cluxel::tasks
