// SPDX-License-Identifier: Apache-2.0
// Moments of the points of each cell, planes of windows of cells, and the patches that they make.
#include "mapping/ways/even_ground.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cluxel::mapping {

namespace {

using perception::GroundTile;
using perception::TileKey;
using perception::TilePoints;

constexpr int kWindowHalf = 2;  // cells: windows have five by five
constexpr double kCellArea_m2 = kWayCell_m * kWayCell_m;
constexpr int kPadded = kCellsPerTile + 2 * kWindowHalf;

/// Sums over points; x and y from the corner of their tile, z from its first height of the ground [m].
struct CellMoments {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;

  void add(double px, double py, double pz, double weight = 1) {
    n += weight, x += weight * px, y += weight * py, z += weight * pz;
    xx += weight * px * px, xy += weight * px * py, yy += weight * py * py;
    xz += weight * px * pz, yz += weight * py * pz, zz += weight * pz * pz;
  }
  void add(const CellMoments& o) {
    n += o.n, x += o.x, y += o.y, z += o.z, xx += o.xx, xy += o.xy, yy += o.yy, xz += o.xz, yz += o.yz, zz += o.zz;
  }
  /// The same points from an origin that lies at -(dx, dy, dz).
  CellMoments shifted(double dx, double dy, double dz) const {
    return {n,
            x + n * dx,
            y + n * dy,
            z + n * dz,
            xx + 2 * dx * x + n * dx * dx,
            xy + dx * y + dy * x + n * dx * dy,
            yy + 2 * dy * y + n * dy * dy,
            xz + dx * z + dz * x + n * dx * dz,
            yz + dy * z + dz * y + n * dy * dz,
            zz + 2 * dz * z + n * dz * dz};
  }
  /// About the means.
  CellMoments centred() const {
    const double mx = x / n, my = y / n, mz = z / n;
    return {n,
            0,
            0,
            0,
            xx - n * mx * mx,
            xy - n * mx * my,
            yy - n * my * my,
            xz - n * mx * mz,
            yz - n * my * mz,
            zz - n * mz * mz};
  }
  /// Of centred moments, the sum of squares of z - a x - b y.
  double residual(double a, double b) const {
    return std::max(0.0, zz - 2 * (a * xz + b * yz) + a * a * xx + 2 * a * b * xy + b * b * yy);
  }
};

/// A cell's points, and the same number of points at their mean.
struct CellPoints {
  CellMoments all, means;
  double cells = 0;

  void add(const CellPoints& o) {
    all.add(o.all), means.add(o.means);
    cells += o.cells;
  }
};

/// Enough points, spread in all directions, lie near one plane that is not steep. How much the ground itself departs
/// from the plane is seen in the means of cells, less what the points' spread within cells lets expect of them: that is
/// noise of the laser. Returns the plane: rise along x, rise along y, height at the origin.
std::optional<Eigen::Vector3d> evenPlane(const CellPoints& sum) {
  constexpr double least_repeats = 30, least_spread_m2 = 0.02, plane_parameters = 3;
  const double n = sum.all.n;
  if (n - sum.cells < least_repeats) return std::nullopt;
  const CellMoments all = sum.all.centred(), means = sum.means.centred();
  const double half = 0.5 * (all.xx + all.yy), difference = 0.5 * (all.xx - all.yy);
  if (!(half - std::sqrt(difference * difference + all.xy * all.xy) >= least_spread_m2 * n)) return std::nullopt;
  const double det = all.xx * all.yy - all.xy * all.xy;
  const double a = (all.xz * all.yy - all.yz * all.xy) / det, b = (all.yz * all.xx - all.xz * all.xy) / det;
  if (a * a + b * b > kEvenSlope * kEvenSlope) return std::nullopt;
  const double between = means.residual(a, b), within = std::max(0.0, all.residual(a, b) - between);
  if (within > kLargestNoise_m * kLargestNoise_m * n) return std::nullopt;
  const double noise = within / (n - sum.cells);
  const double rough = between - noise * std::max(0.0, sum.cells - plane_parameters);
  if (rough > kEvenSpread_m * kEvenSpread_m * n) return std::nullopt;
  return Eigen::Vector3d(a, b, (sum.all.z - a * sum.all.x - b * sum.all.y) / n);
}

/// Fills heights, measured cells and things of a tile; returns the moments of its ground points.
std::vector<CellPoints> momentsOf(const TilePoints& points, const perception::Ring<GroundTile>& ring,
                                  std::uint32_t first_cell, GroundCells& ground) {
  const double base = ring[perception::kRingCentre]->height.front();
  for (std::uint32_t i = 0; i < kCellsOfTile; ++i)
    ground.height[first_cell + i] = static_cast<float>(
        groundHeightAt(ring, (i % kCellsPerTile + 0.5) * kWayCell_m, (i / kCellsPerTile + 0.5) * kWayCell_m));
  std::vector<CellPoints> moments(kCellsOfTile);
  std::vector<double> above(kCellsOfTile, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto at = [](float local) { return std::clamp(static_cast<int>(local / kWayCell_m), 0, kCellsPerTile - 1); };
    const auto cell = static_cast<std::uint32_t>(at(points.y[i]) * kCellsPerTile + at(points.x[i]));
    const double height = static_cast<double>(points.z[i]) - ground.height[first_cell + cell];
    if (std::abs(height) < kThingBottom_m) {
      moments[cell].all.add(points.x[i], points.y[i], points.z[i] - base);
      above[cell] += height;
    } else if (height > 0 && height <= kThingTop_m) {
      ground.thing[first_cell + cell] = 1;
    }
  }
  constexpr double least_points = 3;
  for (std::uint32_t i = 0; i < kCellsOfTile; ++i) {
    ground.measured[first_cell + i] = moments[i].all.n > 0 ? 1 : 0;
    if (moments[i].all.n >= least_points)
      ground.height[first_cell + i] += static_cast<float>(above[i] / moments[i].all.n);
  }
  return moments;
}

/// The height of even ground in a cell is that of the plane of the nearest even window over it.
struct EvenHeights {
  std::vector<float> height;
  std::vector<std::uint8_t> distance2;  ///< [cells], of that window; kNone: there is none
  static constexpr std::uint8_t kNone = 255;
};

/// Marks the cells of each window of the tile of which the points are even: a window whose centre lies in the tile
/// marks cells of the neighbours, too.
void markEven(const std::array<const std::vector<CellPoints>*, 9>& ring, const std::array<double, 9>& base,
              std::uint32_t first_cell, const TileCells& cells, EvenHeights& even) {
  std::vector<CellPoints> padded(kPadded * kPadded), along(kPadded * kPadded);
  for (int row = 0; row < kPadded; ++row)
    for (int column = 0; column < kPadded; ++column) {
      const int x = column - kWindowHalf, y = row - kWindowHalf;
      const int dx = x < 0 ? -1 : x < kCellsPerTile ? 0 : 1, dy = y < 0 ? -1 : y < kCellsPerTile ? 0 : 1;
      const auto tile = static_cast<std::size_t>((dy + 1) * 3 + dx + 1);
      if (ring[tile] == nullptr) continue;
      const int local = (y - dy * kCellsPerTile) * kCellsPerTile + x - dx * kCellsPerTile;
      const CellPoints& own = (*ring[tile])[static_cast<std::size_t>(local)];
      if (own.all.n == 0) continue;
      const double dz = base[tile] - base[perception::kRingCentre];
      CellPoints& cell = padded[static_cast<std::size_t>(row * kPadded + column)];
      cell.all = own.all.shifted(dx * perception::kTileSize_m, dy * perception::kTileSize_m, dz);
      cell.means.add(cell.all.x / own.all.n, cell.all.y / own.all.n, cell.all.z / own.all.n, own.all.n);
      cell.cells = 1;
    }
  for (int row = 0; row < kPadded; ++row)
    for (int column = kWindowHalf; column < kPadded - kWindowHalf; ++column)
      for (int d = -kWindowHalf; d <= kWindowHalf; ++d)
        along[static_cast<std::size_t>(row * kPadded + column)].add(
            padded[static_cast<std::size_t>(row * kPadded + column + d)]);
  for (int y = 0; y < kCellsPerTile; ++y)
    for (int x = 0; x < kCellsPerTile; ++x) {
      CellPoints sum;
      for (int d = 0; d <= 2 * kWindowHalf; ++d)
        sum.add(along[static_cast<std::size_t>((y + d) * kPadded + x + kWindowHalf)]);
      const auto plane = evenPlane(sum);
      if (!plane) continue;
      const std::uint32_t cell = first_cell + static_cast<std::uint32_t>(y * kCellsPerTile + x);
      for (int dy = -kWindowHalf; dy <= kWindowHalf; ++dy)
        for (int dx = -kWindowHalf; dx <= kWindowHalf; ++dx) {
          const std::uint32_t near = cells.step(cell, dx, dy);
          if (near == kNoCell || dx * dx + dy * dy >= even.distance2[near]) continue;
          even.distance2[near] = static_cast<std::uint8_t>(dx * dx + dy * dy);
          even.height[near] =
              static_cast<float>(base[perception::kRingCentre] + plane->z() + plane->x() * (x + dx + 0.5) * kWayCell_m +
                                 plane->y() * (y + dy + 0.5) * kWayCell_m);
        }
    }
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
  for (const auto& hole : connectedCells(cells, rest, false)) {
    if (static_cast<double>(hole.size()) * kCellArea_m2 > largest_m2) continue;
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
  for (const auto& patch : connectedCells(ground.cells, ground.even, true))
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

}  // namespace

std::vector<std::vector<std::uint32_t>> connectedCells(const TileCells& cells, const std::vector<std::uint8_t>& inside,
                                                       bool over_corners) {
  std::vector<std::vector<std::uint32_t>> parts;
  std::vector<std::uint8_t> left = inside;
  for (std::uint32_t start = 0; start < cells.size(); ++start) {
    if (left[start] == 0) continue;
    std::vector<std::uint32_t>& part = parts.emplace_back(1, start);
    left[start] = 0;
    for (std::size_t at = 0; at < part.size(); ++at)
      for (std::size_t way = 0; way < kAroundCell.size(); way += over_corners ? 1 : 2) {
        const std::uint32_t near = cells.step(part[at], kAroundCell[way][0], kAroundCell[way][1]);
        if (near == kNoCell || left[near] == 0) continue;
        left[near] = 0;
        part.push_back(near);
      }
  }
  return parts;
}

GroundCells groundCellsOf(const std::map<TileKey, TilePoints>& points, const std::map<TileKey, GroundTile>& ground) {
  std::vector<TileKey> keys;
  for (const auto& [key, tile] : ground) keys.push_back(key);
  GroundCells result{TileCells(std::move(keys)), {}, {}, {}, {}};
  const std::uint32_t size = result.cells.size();
  result.height.assign(size, 0.0F);
  result.measured.assign(size, 0), result.thing.assign(size, 0), result.even.assign(size, 0);
  EvenHeights even{std::vector<float>(size), std::vector<std::uint8_t>(size, EvenHeights::kNone)};
  // A tile's windows need the moments of its ring. Those of one column of tiles back are kept, no others.
  std::map<TileKey, std::vector<CellPoints>> moments;
  const auto finish = [&](std::uint32_t slot) {
    const TileKey key = result.cells.keys()[slot];
    const auto around = perception::ringOf(key);
    std::array<const std::vector<CellPoints>*, 9> ring{};
    std::array<double, 9> base{};
    for (std::size_t i = 0; i < around.size(); ++i)
      if (const auto found = moments.find(around[i]); found != moments.end()) {
        ring[i] = &found->second;
        base[i] = ground.at(around[i]).height.front();
      }
    if (ring[perception::kRingCentre] != nullptr) markEven(ring, base, slot * kCellsOfTile, result.cells, even);
    moments.erase(moments.begin(), moments.lower_bound({key.x - 1, key.y - 1}));
  };
  std::uint32_t finished = 0;
  for (std::uint32_t slot = 0; slot < result.cells.keys().size(); ++slot) {
    const TileKey key = result.cells.keys()[slot];
    if (const auto found = points.find(key); found != points.end())
      moments.emplace(key, momentsOf(found->second, perception::ringIn(ground, key), slot * kCellsOfTile, result));
    const auto is_done = [&](const TileKey& tile) { return TileKey{tile.x + 1, tile.y + 1} <= key; };
    while (is_done(result.cells.keys()[finished])) finish(finished++);
  }
  while (finished < result.cells.keys().size()) finish(finished++);
  for (std::uint32_t cell = 0; cell < size; ++cell) result.even[cell] = even.distance2[cell] != EvenHeights::kNone;
  bridgeGaps(even, result);
  closeHoles(even, kLargestGap_m2, result);
  cutAtSteps(even, result);
  closeHoles(even, kLargestCut_m2, result);
  dropSmallPatches(result);
  return result;
}

}  // namespace cluxel::mapping
