// SPDX-License-Identifier: Apache-2.0
// Gathers points of the ring and sorts them by cell.
#include "perception/point_grid.hpp"

#include "perception/radix_order.hpp"

namespace cluxel {
namespace {

void resize(PointGrid& points, std::size_t size) {
  for (auto* values : {&points.x, &points.y, &points.z}) values->resize(size);
  points.own.resize(size);
}

/// The points of the ring that lie in the margin, tile by tile.
PointGrid gather(const Ring<TilePoints>& ring, float margin_m) {
  PointGrid points;
  const float low = -margin_m, high = static_cast<float>(kTileSize_m) + margin_m;
  std::size_t count = 0, expected = 0;
  for (const TilePoints* tile : ring) expected += tile == nullptr ? 0 : tile->size();
  resize(points, expected);
  for (int r = 0; r < 9; ++r) {
    const TilePoints* tile = ring[static_cast<std::size_t>(r)];
    if (tile == nullptr) continue;
    const Eigen::Vector3f shift = ringShift(r);
    for (std::uint32_t i = 0; i < tile->size(); ++i) {   // written first, counted if it lies there
      const float x = tile->x[i] + shift.x(), y = tile->y[i] + shift.y();
      points.x[count] = x;
      points.y[count] = y;
      points.z[count] = tile->z[i];
      points.own[count] = r == kRingCentre ? i : PointGrid::kForeign;
      count += (x >= low) & (x <= high) & (y >= low) & (y <= high) ? 1U : 0U;
    }
  }
  resize(points, count);
  return points;
}

}  // namespace

CellKeys::CellKeys(double cell_m, double margin_m) {
  // A little wider than asked for, so that rounding never puts two points within cell_m into cells that are not neighbours.
  const double wide_m = cell_m * 1.0001;
  per_m_ = 1.0 / wide_m;
  // A whole number of cells, so that cells of the tile begin at its corner; one more keeps neighbours positive.
  offset_ = (std::ceil(margin_m * per_m_) + 1.0) * wide_m;
}

void endKeys(std::vector<std::uint64_t>& cell_key) {
  constexpr std::uint64_t kBeyondAll = ~std::uint64_t{0} - 1;   // one more is still a number
  cell_key.insert(cell_key.end(), 3, kBeyondAll);
}

PointGrid gridOf(const Ring<TilePoints>& ring, double cell_m, double margin_m) {
  const PointGrid points = gather(ring, static_cast<float>(margin_m));
  const CellKeys key(cell_m, margin_m);
  std::vector<KeyedItem> order(points.x.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = {key(points.x[i], points.y[i], points.z[i]), i};
  if (!order.empty()) sortByKey(order);
  PointGrid grid;
  resize(grid, order.size() + PointGrid::kSpare);
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    const std::uint32_t from = order[i].item;
    grid.x[i] = points.x[from];
    grid.y[i] = points.y[from];
    grid.z[i] = points.z[from];
    grid.own[i] = points.own[from];
    if (i == 0 || order[i].key != order[i - 1].key) {
      grid.cell_key.push_back(order[i].key);
      grid.cell_start.push_back(i);
    }
  }
  grid.cell_start.push_back(static_cast<std::uint32_t>(order.size()));
  endKeys(grid.cell_key);
  return grid;
}

}  // namespace cluxel
