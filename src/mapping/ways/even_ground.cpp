// SPDX-License-Identifier: Apache-2.0
// The even cells of some tiles, and the patches that they make.
#include "mapping/ways/even_ground.hpp"

#include <algorithm>
#include <cmath>

#include "perception/features/cell_moments.hpp"

namespace cluxel::mapping {

namespace {

using perception::CellMoments;
using perception::TileKey;

constexpr double kCellArea_m2 = kWayCell_m * kWayCell_m;

/// The height of even ground in a cell is that of the plane of the nearest even window over it.
struct EvenHeights {
  std::vector<float> height;
  std::vector<std::uint8_t> distance2;  ///< [cells], of that window; kNone: there is none
  static constexpr std::uint8_t kNone = perception::EvenTile::kNotEven;
};

/// Connected cells where `left` is 1, over the four neighbours or all eight, if they have at most an area and span at
/// most kLongestPart columns and rows. Cells of a part are in the order in which they are found; parts are in the order
/// of their first cells.
std::vector<std::vector<std::uint32_t>> smallParts(const TileCells& cells, std::vector<std::uint8_t> left,
                                                   bool over_corners, double largest_m2) {
  std::vector<std::vector<std::uint32_t>> parts;
  std::vector<std::uint32_t> part;
  for (std::uint32_t start = 0; start < cells.size(); ++start) {
    if (left[start] == 0) continue;
    part.assign(1, start);
    left[start] = 0;
    CellPlace min = cells.placeOf(start), max = min;
    for (std::size_t at = 0; at < part.size(); ++at) {
      const CellPlace place = cells.placeOf(part[at]);
      min = {std::min(min.x, place.x), std::min(min.y, place.y)};
      max = {std::max(max.x, place.x), std::max(max.y, place.y)};
      for (std::size_t way = 0; way < kAroundCell.size(); way += over_corners ? 1 : 2) {
        const std::uint32_t near = cells.step(part[at], kAroundCell[way][0], kAroundCell[way][1]);
        if (near == kNoCell || left[near] == 0) continue;
        left[near] = 0;
        part.push_back(near);
      }
    }
    const bool is_short = std::max(max.x - min.x, max.y - min.y) < kLongestPart;
    if (is_short && static_cast<double>(part.size()) * kCellArea_m2 <= largest_m2) parts.push_back(part);
  }
  return parts;
}

/// Whether the even cells around a hole lie in one plane: then it is a thing on even ground, or its shadow, and no kerb
/// runs through it.
bool isFlatAround(const std::vector<std::uint32_t>& hole, const TileCells& cells, const EvenHeights& even) {
  std::vector<Eigen::Vector3d> rim;
  CellMoments sum;
  const Eigen::Vector2d origin = cells.centreOf(hole.front());
  for (const std::uint32_t cell : hole)
    for (const auto& [dx, dy] : kAroundCell) {
      const std::uint32_t near = cells.step(cell, dx, dy);
      if (near == kNoCell || even.distance2[near] == EvenHeights::kNone) continue;
      const Eigen::Vector2d place = cells.centreOf(near) - origin;
      rim.emplace_back(place.x(), place.y(), even.height[near] - even.height[cells.step(hole.front(), 0, -1)]);
      sum.add(rim.back().x(), rim.back().y(), rim.back().z());
    }
  const CellMoments all = sum.centred();
  const double det = all.xx * all.yy - all.xy * all.xy;
  const double a = (all.xz * all.yy - all.yz * all.xy) / det, b = (all.yz * all.xx - all.xz * all.xy) / det;
  const double c = (sum.z - a * sum.x - b * sum.y) / sum.n;
  return std::all_of(rim.begin(), rim.end(), [&](const Eigen::Vector3d& p) {
    return std::abs(p.z() - a * p.x() - b * p.y() - c) <= 0.5 * kKerbLow_m;
  });
}

/// Closes holes in even ground up to an area. A hole ends within the tiles.
void closeHoles(const EvenHeights& even, double largest_m2, GroundCells& ground) {
  const TileCells& cells = ground.cells;
  std::vector<std::uint8_t> rest(ground.even.size());
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) rest[cell] = ground.even[cell] == 0 ? 1 : 0;
  for (const auto& hole : smallParts(cells, std::move(rest), false, largest_m2)) {
    const bool is_open = std::any_of(hole.begin(), hole.end(), [&](std::uint32_t cell) {
      return cells.step(cell, 1, 0) == kNoCell || cells.step(cell, -1, 0) == kNoCell ||
             cells.step(cell, 0, 1) == kNoCell || cells.step(cell, 0, -1) == kNoCell;
    });
    if (is_open || !isFlatAround(hole, cells, even)) continue;
    for (const std::uint32_t cell : hole) ground.even[cell] = 1;
  }
}

/// Joins even ground over gaps of one cell without a kerb: joints, and steps that are lower.
void bridgeGaps(EvenHeights& even, GroundCells& ground) {
  const std::vector<std::uint8_t> before = ground.even;
  for (std::uint32_t cell = 0; cell < ground.cells.size(); ++cell)
    for (std::size_t way = 0; way < kAroundCell.size() / 2 && ground.even[cell] == 0; ++way) {
      const auto& [dx, dy] = kAroundCell[way];
      const std::uint32_t a = ground.cells.step(cell, dx, dy), b = ground.cells.step(cell, -dx, -dy);
      if (a == kNoCell || b == kNoCell || before[a] == 0 || before[b] == 0) continue;
      if (std::abs(even.height[a] - even.height[b]) > kKerbLow_m) continue;
      ground.even[cell] = 1;
      even.height[cell] = 0.5F * (even.height[a] + even.height[b]);
      even.distance2[cell] = EvenHeights::kNone - 1;
    }
}

void dropSmallPatches(GroundCells& ground) {
  for (const auto& patch : smallParts(ground.cells, ground.even, true, kLeastEven_m2))
    if (static_cast<double>(patch.size()) * kCellArea_m2 < kLeastEven_m2)
      for (const std::uint32_t cell : patch) ground.even[cell] = 0;
}

/// Even ground ends at a step: the lower cell does not belong to it.
void cutAtSteps(const EvenHeights& even, GroundCells& ground) {
  const auto has_height = [&](std::uint32_t cell) {
    return cell != kNoCell && even.distance2[cell] != EvenHeights::kNone;
  };
  for (std::uint32_t cell = 0; cell < ground.cells.size(); ++cell) {
    if (!has_height(cell)) continue;
    for (const auto& [dx, dy] : kAroundCell)
      if (const std::uint32_t near = ground.cells.step(cell, dx, dy); has_height(near))
        if (even.height[near] - even.height[cell] > kKerbLow_m) ground.even[cell] = 0;
  }
}

/// Puts the tiles' arrays one after the other.
template <typename Values>
void append(const Values& values, Values& all) {
  all.insert(all.end(), values.begin(), values.end());
}

void appendGround(const perception::EvenTile& tile, GroundCells& ground) {
  append(tile.height, ground.height), append(tile.measured, ground.measured), append(tile.thing, ground.thing);
}

GroundCells emptyGround(std::vector<TileKey> keys) {
  GroundCells ground{TileCells(std::move(keys)), {}, {}, {}, {}};
  const std::uint32_t size = ground.cells.size();
  ground.height.reserve(size), ground.measured.reserve(size), ground.thing.reserve(size), ground.even.reserve(size);
  return ground;
}

}  // namespace

GroundCells surfaceOf(std::vector<TileKey> keys, const EvenTileSource& tileAt) {
  GroundCells result = emptyGround(std::move(keys));
  EvenHeights even;
  even.height.reserve(result.cells.size()), even.distance2.reserve(result.cells.size());
  for (const TileKey& key : result.cells.keys()) {
    const perception::EvenTile tile = tileAt(key);
    appendGround(tile, result);
    append(tile.even_height, even.height), append(tile.distance2, even.distance2);
  }
  for (const std::uint8_t distance2 : even.distance2) result.even.push_back(distance2 != EvenHeights::kNone ? 1 : 0);
  bridgeGaps(even, result);
  closeHoles(even, kLargestGap_m2, result);
  cutAtSteps(even, result);
  closeHoles(even, kLargestCut_m2, result);
  dropSmallPatches(result);
  return result;
}

GroundCells groundCellsOf(std::vector<TileKey> keys, const EvenTileSource& tileAt, const SurfaceTileSource& surfaceAt) {
  GroundCells result = emptyGround(std::move(keys));
  for (const TileKey& key : result.cells.keys()) {
    appendGround(tileAt(key), result);
    append(surfaceAt(key), result.even);
  }
  return result;
}

}  // namespace cluxel::mapping
