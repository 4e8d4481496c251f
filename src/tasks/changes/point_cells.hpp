// SPDX-License-Identifier: Apache-2.0
// The points before and after a time in cells of a decimetre, and what the rays of both times found there.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "mapping/regions/map_regions.hpp"
#include "perception/tile.hpp"
#include "perception/visibility/scan_rays.hpp"
#include "tasks/changes/changed_cluxels.hpp"

namespace cluxel::tasks {

/// What the rays of some scans found at a place.
struct RayLooks {
  ScanNumbers hit_scans{};      ///< scans of which a ray ended there
  ScanNumbers through_scans{};  ///< scans of which rays passed; those of which a ray ended there, too, do not count
  perception::RayCounts rays{};
  std::uint64_t passing_rays = 0, stopped_rays = 0;  ///< as in RayFindings

  std::size_t hits() const { return hit_scans.size(); }
  std::size_t through() const { return through_scans.sizeWithout(hit_scans); }
};

/// A cell lies in one tile of the map.
struct CellKey {
  perception::TileKey tile;
  std::uint64_t cell = 0;  ///< in the tile
  auto operator<=>(const CellKey&) const = default;
};

/// A cell in which scans of one time measured points.
struct PointCell {
  CellKey key{};
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< the mean of these points [m, map]
  std::uint32_t cluxel = 0;                         ///< of the first of them, in the scene of the map
  std::uint32_t object = 0;                         ///< of that cluxel, in MapReader::objects(), or kNoObject
  bool is_foliage = false;                          ///< the label of that cluxel
  /// The other time measured more than a third as many points in the cell. No rays are looked at then.
  bool is_shared = false;
  bool is_of_changed_cluxel = false;  ///< its cluxel vanished, of cells before, or appeared, of cells after
  ScanNumbers scans{};                ///< that measured the points
  RayLooks own{}, other{};            ///< of the scans of that time, and of the other time
};

/// The cells with points before and after a time, by key.
using PointCells = std::array<std::vector<PointCell>, 2>;
inline constexpr std::size_t kBefore = 0, kAfter = 1;

/// Gathers points in cells.
class CellSums {
 public:
  explicit CellSums(const perception::TileGrid& grid) : grid_(grid) {}
  /// `time`: kBefore or kAfter. `cluxel`: number in the scene of a region.
  void add(std::size_t time, std::uint32_t scan, const Eigen::Vector3d& p_map, std::uint32_t cluxel);
  /// The cells; the sums are empty afterwards.
  PointCells take(const mapping::MapRegion& region);

 private:
  struct Hash {
    std::size_t operator()(const CellKey& key) const;
  };
  /// The points of each time in a cell.
  struct PointSums {
    std::array<Eigen::Vector3d, 2> sum{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    std::array<std::uint32_t, 2> count{}, cluxel{};
    std::array<ScanNumbers, 2> scans{};
  };
  perception::TileGrid grid_;
  std::unordered_map<CellKey, PointSums, Hash> sums_;
};

/// Cells near to each other lie within this distance [m].
inline constexpr double kNearCells_m = 0.25;

/// Compares the rays of a scan with those of the cells that are not shared.
void lookAtCells(const perception::ScanRays& rays, std::uint32_t scan, RayLooks PointCell::*looks,
                 std::span<PointCell> cells);

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
