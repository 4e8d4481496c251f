// SPDX-License-Identifier: Apache-2.0
// Gathers points of the ring and sorts them by cell.
#include "perception/point_grid.hpp"

#include "perception/radix_order.hpp"

namespace cluxel {
namespace {

/// The points of the ring that lie in the margin, tile by tile.
PointGrid gather(const Ring<TilePoints>& ring, float margin_m) {
  PointGrid points;
  const float low = -margin_m, high = static_cast<float>(kTileSize_m) + margin_m;
  const std::size_t expected = ring[kRingCentre] == nullptr ? 0 : ring[kRingCentre]->size() * 5 / 4;
  for (auto* values : {&points.x, &points.y, &points.z}) values->reserve(expected);
  points.own.reserve(expected);
  for (int r = 0; r < 9; ++r) {
    const TilePoints* tile = ring[static_cast<std::size_t>(r)];
    if (tile == nullptr) continue;
    const Eigen::Vector3f shift = ringShift(r);
    for (std::uint32_t i = 0; i < tile->size(); ++i) {
      const float x = tile->x[i] + shift.x(), y = tile->y[i] + shift.y();
      if (x < low || x > high || y < low || y > high) continue;
      points.x.push_back(x);
      points.y.push_back(y);
      points.z.push_back(tile->z[i]);
      points.own.push_back(r == kRingCentre ? i : PointGrid::kForeign);
    }
  }
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

PointGrid gridOf(const Ring<TilePoints>& ring, double cell_m, double margin_m) {
  const PointGrid points = gather(ring, static_cast<float>(margin_m));
  const CellKeys key(cell_m, margin_m);
  std::vector<KeyedItem> order(points.x.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = {key(points.x[i], points.y[i], points.z[i]), i};
  if (!order.empty()) sortByKey(order);
  PointGrid grid;
  grid.x.resize(order.size());
  grid.y.resize(order.size());
  grid.z.resize(order.size());
  grid.own.resize(order.size());
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
  return grid;
}

}  // namespace cluxel
