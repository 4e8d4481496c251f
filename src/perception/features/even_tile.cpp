// SPDX-License-Identifier: Apache-2.0
// Moments of the points of each cell, planes of windows of cells, and the cells that these cover.
#include "perception/features/even_tile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "perception/features/cell_moments.hpp"
#include "perception/tile_bytes.hpp"

namespace cluxel::perception {

namespace {

constexpr int kHalfWindow = 2;  // cells: windows have five by five
/// Windows are centred up to half a window outside of the tile, and read as far again.
constexpr int kMargin = 2 * kHalfWindow;
static_assert(kMargin * kEvenCell_m <= kEvenMargin_m);
constexpr int kPaddedCells = kEvenCellsPerTile + 2 * kMargin;

std::size_t paddedIndex(int x, int y) {
  return static_cast<std::size_t>((y + kMargin) * kPaddedCells + x + kMargin);
}

double cellCentre(int at) {
  return (at + 0.5) * kEvenCell_m;
}

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

/// The cells of a tile and of a margin around it.
struct PaddedGround {
  double base_m = 0;                ///< near the ground [m, map]
  std::vector<float> height;        ///< of the ground above the base [m]
  std::vector<CellPoints> moments;  ///< of points of the ground
  std::vector<double> above;        ///< the same points' heights above the ground, summed [m]
  std::vector<std::uint8_t> thing;
};

PaddedGround gatherGround(const Ring<TilePoints>& points, const Ring<GroundTile>& ground) {
  constexpr std::size_t count = static_cast<std::size_t>(kPaddedCells) * kPaddedCells;
  const double base = ground[kRingCentre]->height.front();
  PaddedGround all{base, std::vector<float>(count), std::vector<CellPoints>(count), std::vector<double>(count, 0),
                   std::vector<std::uint8_t>(count, 0)};
  for (int y = -kMargin; y < kEvenCellsPerTile + kMargin; ++y)
    for (int x = -kMargin; x < kEvenCellsPerTile + kMargin; ++x)
      all.height[paddedIndex(x, y)] = static_cast<float>(groundHeightAt(ground, cellCentre(x), cellCentre(y)) - base);
  for (int r = 0; r < static_cast<int>(points.size()); ++r) {
    const TilePoints* tile = points[static_cast<std::size_t>(r)];
    if (tile == nullptr) continue;
    const Eigen::Vector3f shift = ringShift(r);
    const int first_x = kEvenCellsPerTile * (r % 3 - 1), first_y = kEvenCellsPerTile * (r / 3 - 1);
    for (std::size_t i = 0; i < tile->size(); ++i) {
      const auto at = [](float local) {
        return std::clamp(static_cast<int>(local / kEvenCell_m), 0, kEvenCellsPerTile - 1);
      };
      const auto is_near = [](int cell) { return cell >= -kMargin && cell < kEvenCellsPerTile + kMargin; };
      const int x = first_x + at(tile->x[i]), y = first_y + at(tile->y[i]);
      if (!is_near(x) || !is_near(y)) continue;
      const std::size_t cell = paddedIndex(x, y);
      const double above = tile->z[i] - base - all.height[cell];
      if (std::abs(above) < kThingBottom_m) {
        all.moments[cell].all.add(tile->x[i] + shift.x(), tile->y[i] + shift.y(), tile->z[i] - base);
        all.above[cell] += above;
      } else if (above > 0 && above <= kThingTop_m) {
        all.thing[cell] = 1;
      }
    }
  }
  for (CellPoints& cell : all.moments) {
    if (cell.all.n == 0) continue;
    cell.means.add(cell.all.x / cell.all.n, cell.all.y / cell.all.n, cell.all.z / cell.all.n, cell.all.n);
    cell.cells = 1;
  }
  return all;
}

float rounded(double height_m) {
  return static_cast<float>(std::floor(height_m / kEvenStep_m + 0.5) * kEvenStep_m);
}

/// Heights, measured cells and things of the tile itself.
void fillCells(const PaddedGround& all, EvenTile& tile) {
  constexpr double least_points = 3;
  for (int y = 0; y < kEvenCellsPerTile; ++y)
    for (int x = 0; x < kEvenCellsPerTile; ++x) {
      const std::size_t cell = paddedIndex(x, y);
      const double n = all.moments[cell].all.n;
      tile.measured.push_back(n > 0 ? 1 : 0);
      tile.thing.push_back(all.thing[cell]);
      tile.height.push_back(rounded(all.base_m + all.height[cell] + (n >= least_points ? all.above[cell] / n : 0)));
    }
}

/// Marks the cells of the window around a cell: they have the height of the plane unless a nearer window gave one.
void markWindow(int x, int y, const Eigen::Vector3d& plane, double base, EvenTile& tile) {
  for (int dy = -kHalfWindow; dy <= kHalfWindow; ++dy)
    for (int dx = -kHalfWindow; dx <= kHalfWindow; ++dx) {
      const int column = x + dx, row = y + dy;
      if (std::min(column, row) < 0 || std::max(column, row) >= kEvenCellsPerTile) continue;
      const auto cell = static_cast<std::size_t>(row * kEvenCellsPerTile + column);
      if (dx * dx + dy * dy >= tile.distance2[cell]) continue;
      tile.distance2[cell] = static_cast<std::uint8_t>(dx * dx + dy * dy);
      tile.even_height[cell] = rounded(base + plane.z() + plane.x() * cellCentre(column) + plane.y() * cellCentre(row));
    }
}

/// Windows in the order of their centres, row by row.
void markEven(const PaddedGround& all, double base, EvenTile& tile) {
  tile.distance2.assign(kEvenCellsOfTile, EvenTile::kNotEven);
  tile.even_height.assign(kEvenCellsOfTile, 0.0F);
  std::vector<CellPoints> along(all.moments.size());
  for (int y = -kMargin; y < kEvenCellsPerTile + kMargin; ++y)
    for (int x = -kHalfWindow; x < kEvenCellsPerTile + kHalfWindow; ++x)
      for (int d = -kHalfWindow; d <= kHalfWindow; ++d)
        along[paddedIndex(x, y)].add(all.moments[paddedIndex(x + d, y)]);
  for (int y = -kHalfWindow; y < kEvenCellsPerTile + kHalfWindow; ++y)
    for (int x = -kHalfWindow; x < kEvenCellsPerTile + kHalfWindow; ++x) {
      CellPoints sum;
      for (int d = -kHalfWindow; d <= kHalfWindow; ++d) sum.add(along[paddedIndex(x, y + d)]);
      if (const auto plane = evenPlane(sum)) markWindow(x, y, *plane, base, tile);
    }
}

/// Heights as whole steps: near cells have near numbers.
std::vector<std::uint32_t> stepsOf(const std::vector<float>& heights) {
  std::vector<std::uint32_t> steps;
  steps.reserve(heights.size());
  for (const float height : heights)
    steps.push_back(static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(height / kEvenStep_m))));
  return steps;
}

std::vector<float> heightsFrom(const std::vector<std::uint32_t>& steps) {
  std::vector<float> heights;
  heights.reserve(steps.size());
  for (const std::uint32_t step : steps)
    heights.push_back(static_cast<float>(static_cast<std::int32_t>(step) * kEvenStep_m));
  return heights;
}

}  // namespace

EvenTile evenGroundOf(const Ring<TilePoints>& points, const Ring<GroundTile>& ground) {
  const PaddedGround all = gatherGround(points, ground);
  EvenTile tile;
  tile.key = ground[kRingCentre]->key;
  fillCells(all, tile);
  markEven(all, ground[kRingCentre]->height.front(), tile);
  return tile;
}

std::string toBytes(const EvenTile& tile) {
  TileWriter writer("EVEN", 1, tile.key);
  writer.putSteps(stepsOf(tile.height));
  writer.put(tile.measured);
  writer.put(tile.thing);
  writer.put(tile.distance2);
  writer.putSteps(stepsOf(tile.even_height));
  return writer.take();
}

EvenTile evenTileFromBytes(std::string_view bytes) {
  TileReader reader(bytes, "EVEN", 1);
  EvenTile tile;
  tile.key = reader.key();
  tile.height = heightsFrom(reader.getSteps(kEvenCellsOfTile));
  tile.measured = reader.getMany<std::uint8_t>(kEvenCellsOfTile);
  tile.thing = reader.getMany<std::uint8_t>(kEvenCellsOfTile);
  tile.distance2 = reader.getMany<std::uint8_t>(kEvenCellsOfTile);
  tile.even_height = heightsFrom(reader.getSteps(kEvenCellsOfTile));
  reader.finish();
  reader.require(allWithin(tile.height, 4 * kMaxHeight_m) && allWithin(tile.even_height, 4 * kMaxHeight_m),
                 "has an impossible height");
  for (const auto* flags : {&tile.measured, &tile.thing})
    reader.require(std::all_of(flags->begin(), flags->end(), [](auto flag) { return flag <= 1; }),
                   "has an impossible flag");
  return tile;
}

}  // namespace cluxel::perception
