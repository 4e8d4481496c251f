// SPDX-License-Identifier: Apache-2.0
// Cells are cut within tiles, so that no cell lies in two.
#include "tasks/changes/point_cells.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cluxel::tasks {

namespace {

using perception::RayVerdict;
using BlockKey = std::uint64_t;

constexpr double kCell_m = 0.1, kNear_m = kNearCells_m;
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

/// Eight bits for x and for y, which are below 160, and the rest for z.
CellKey cellOf(const perception::TileGrid& grid, const Eigen::Vector3d& p_map) {
  constexpr double kPerTile = perception::kTileSize_m / kCell_m;
  constexpr std::int64_t kLowest = -(std::int64_t{1} << 40);
  const perception::TileKey tile = grid.tileOf(p_map);
  const Eigen::Vector3d local = grid.fromMap(p_map) - perception::TileGrid().cornerOf(tile);
  const auto number = [](double at) {
    return static_cast<std::uint64_t>(std::clamp(std::floor(at / kCell_m), 0.0, kPerTile - 1));
  };
  const auto height = static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(local.z() / kCell_m)) - kLowest);
  return {tile, number(local.x()) << 56U | number(local.y()) << 48U | height};
}

}  // namespace

std::size_t CellSums::Hash::operator()(const CellKey& key) const {
  constexpr std::uint64_t kMultiplier = 0x9E3779B97F4A7C15U;
  std::uint64_t hash = key.cell * kMultiplier;
  hash = (hash ^ hash >> 32U ^ static_cast<std::uint32_t>(key.tile.x)) * kMultiplier;
  hash = (hash ^ hash >> 32U ^ static_cast<std::uint32_t>(key.tile.y)) * kMultiplier;
  return hash ^ hash >> 32U;
}

void CellSums::add(std::size_t time, std::uint32_t scan, const Eigen::Vector3d& p_map, std::uint32_t cluxel) {
  PointSums& cell = sums_[cellOf(grid_, p_map)];
  if (cell.count[time] == 0) cell.cluxel[time] = cluxel;
  cell.sum[time] += p_map;
  ++cell.count[time];
  cell.scans[time].insert(scan);
}

PointCells CellSums::take(const mapping::MapRegion& region) {
  PointCells cells;
  for (const std::size_t time : {kBefore, kAfter})
    cells[time].reserve(static_cast<std::size_t>(
        std::count_if(sums_.begin(), sums_.end(), [&](const auto& of_key) { return of_key.second.count[time] > 0; })));
  for (const auto& [key, sums] : sums_)
    for (const std::size_t time : {kBefore, kAfter}) {
      const std::uint32_t count = sums.count[time], cluxel = sums.cluxel[time];
      if (count == 0) continue;
      PointCell& cell = cells[time].emplace_back();
      cell.key = key, cell.place = sums.sum[time] / count, cell.scans = sums.scans[time];
      cell.cluxel = region.number[cluxel], cell.object = region.object[cluxel];
      cell.is_foliage = region.scene.cluxels.label[cluxel] == scan::PrimitiveLabel::Scatter;
      cell.is_shared = kMuchMore * sums.count[1 - time] > count;
    }
  sums_ = {};
  for (auto& of_time : cells)
    std::sort(of_time.begin(), of_time.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  return cells;
}

void lookAtCells(const perception::ScanRays& rays, std::uint32_t scan, RayLooks PointCell::*looks,
                 std::span<PointCell> cells) {
  for (PointCell& cell : cells) {
    if (cell.is_shared) continue;
    const perception::PlaceVerdict found = rays.verdictAt(cell.place, kRayParams);
    RayLooks& of_cell = cell.*looks;
    of_cell.rays += found.rays;
    if (found.verdict == RayVerdict::Hit) of_cell.hit_scans.insert(scan);
    if (found.verdict != RayVerdict::SeenThrough && found.verdict != RayVerdict::FewPassed) continue;
    of_cell.through_scans.insert(scan);
    of_cell.passing_rays += found.rays.passed, of_cell.stopped_rays += found.stopped;
  }
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
