// SPDX-License-Identifier: Apache-2.0
// Gathers points of the ring and sorts them by cell.
#include "perception/clustering/point_grid.hpp"

#include "base/radix_order.hpp"
#include "perception/simd_vector.hpp"

namespace cluxel::perception {
namespace {

void append(PointGrid& points, float x, float y, float z, std::uint32_t own) {
  points.x.push_back(x);
  points.y.push_back(y);
  points.z.push_back(z);
  points.own.push_back(own);
}

void appendOwn(const TilePoints& tile, PointGrid& points) {
  points.x.insert(points.x.end(), tile.x.begin(), tile.x.end());
  points.y.insert(points.y.end(), tile.y.begin(), tile.y.end());
  points.z.insert(points.z.end(), tile.z.begin(), tile.z.end());
  for (std::uint32_t i = 0; i < tile.size(); ++i) points.own.push_back(i);
}

/// A neighbour's points that lie in the margin. They are few, so that four points are tested at a time.
void appendNear(const TilePoints& tile, const Eigen::Vector3f& shift, float margin_m, PointGrid& points) {
  const float low = -margin_m, high = static_cast<float>(kTileSize_m) + margin_m;
  const auto appendOne = [&](std::size_t i) {
    const float x = tile.x[i] + shift.x(), y = tile.y[i] + shift.y();
    if (x >= low && x <= high && y >= low && y <= high) append(points, x, y, tile.z[i], PointGrid::kForeign);
  };
  std::size_t i = 0;
  for (; i + kLanes <= tile.size(); i += kLanes) {
    const Floats x = loadFloats(tile.x.data() + i) + shift.x(), y = loadFloats(tile.y.data() + i) + shift.y();
    if (lanesThatHold((x >= low) & (x <= high) & (y >= low) & (y <= high)) == 0) continue;
    for (std::size_t lane = 0; lane < kLanes; ++lane) appendOne(i + lane);
  }
  for (; i < tile.size(); ++i) appendOne(i);
}

/// The points of the ring that lie in the margin, tile by tile.
PointGrid gather(const Ring<TilePoints>& ring, float margin_m) {
  PointGrid points;
  const std::size_t expected = ring[kRingCentre] == nullptr ? 0 : ring[kRingCentre]->size() * 5 / 4;
  for (auto* values : {&points.x, &points.y, &points.z}) values->reserve(expected);
  points.own.reserve(expected);
  for (int r = 0; r < 9; ++r) {
    const TilePoints* tile = ring[static_cast<std::size_t>(r)];
    if (tile == nullptr) continue;
    if (r == kRingCentre)
      appendOwn(*tile, points);
    else
      appendNear(*tile, ringShift(r), margin_m, points);
  }
  return points;
}

}  // namespace

CellKeys::CellKeys(double cell_m, double margin_m) {
  // Slightly larger cells, so that rounding never puts two points within cell_m into cells that are not neighbours.
  const double wide_m = cell_m * 1.0001;
  per_m_ = 1.0 / wide_m;
  // A whole number of cells, so that a cell begins at the tile's corner; one more keeps neighbours positive.
  offset_ = (std::ceil(margin_m * per_m_) + 1.0) * wide_m;
  layers_per_m_ = std::max(1.0, std::floor(kTileSize_m * per_m_)) / kTileSize_m;
}

void endKeys(std::vector<std::uint64_t>& cell_key) {
  constexpr std::uint64_t kBeyondAll = ~std::uint64_t{0} - 1;  // adding one does not overflow
  cell_key.insert(cell_key.end(), 3, kBeyondAll);
}

PointGrid gridOf(const Ring<TilePoints>& ring, double cell_m, double margin_m) {
  const PointGrid points = gather(ring, static_cast<float>(margin_m));
  const CellKeys key(cell_m, margin_m);
  const std::size_t count = points.x.size();
  std::vector<std::uint64_t> keys(count);
  for (std::size_t i = 0; i < count; ++i) keys[i] = key(points.x[i], points.y[i], points.z[i]);
  const std::vector<std::uint32_t> order = orderOf(keys);
  PointGrid grid;
  for (auto* values : {&grid.x, &grid.y, &grid.z}) values->resize(count + PointGrid::kSpare);
  grid.own.resize(count);
  grid.cell_key.resize(count + 1);
  grid.cell_start.resize(count + 1);
  std::size_t cells = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t from = order[i];
    grid.x[i] = points.x[from];
    grid.y[i] = points.y[from];
    grid.z[i] = points.z[from];
    grid.own[i] = points.own[from];
    // Branchless: the end of the cell is overwritten by each of its points.
    cells += i == 0 || keys[from] != grid.cell_key[cells] ? 1U : 0U;
    grid.cell_key[cells] = keys[from];
    grid.cell_start[cells] = i + 1;
  }
  grid.cell_key.erase(grid.cell_key.begin());
  grid.cell_key.resize(cells);
  grid.cell_start.resize(cells + 1);
  endKeys(grid.cell_key);
  return grid;
}

}  // namespace cluxel::perception
