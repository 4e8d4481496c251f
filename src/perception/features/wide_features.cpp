// SPDX-License-Identifier: Apache-2.0
// Shapes of cubes of 1.5 m and 3 m, which tell a wall behind leaves from leaves alone: merged moments of 27 grid cells,
// computed once per cell and shared by its cluxels.
#include <array>
#include <cmath>

#include "base/radix_order.hpp"
#include "perception/clustering/point_grid.hpp"
#include "perception/features/feature_groups.hpp"

namespace cluxel::perception {
namespace {

constexpr std::array<double, 2> kCells_m{0.5, 1.0};  // ascending
static_assert(kCells_m.back() <= kFeatureMargin_m);
constexpr std::size_t kColumnsPerScale = 8;

/// Cluxels in and near the tile, summed per grid cell relative to the first cluxel of the tile.
struct CellSums {
  std::vector<std::uint64_t> key;
  std::vector<MomentSum> sum;
  std::vector<std::uint8_t> has_chosen;
  std::vector<std::uint32_t> cell_of_own;
};

struct Item {
  Eigen::Vector3f center;
  std::array<float, 6> spread;  ///< mean products of its points' deviations [m2]
  std::uint32_t number;         ///< number in the centre tile, or PointGrid::kForeign
};

bool isNear(const Eigen::Vector3f& center, double margin_m) {
  const auto low = static_cast<float>(-margin_m), high = static_cast<float>(kTileSize_m) + static_cast<float>(margin_m);
  return center.x() >= low && center.x() <= high && center.y() >= low && center.y() <= high;
}

std::vector<Item> itemsNear(const Ring<CluxelTile>& ring, double margin_m) {
  std::vector<Item> items;
  items.reserve(2 * ring[kRingCentre]->size());
  for (int r = 0; r < 9; ++r) {
    const CluxelTile* tile = ring[static_cast<std::size_t>(r)];
    if (tile == nullptr) continue;
    const Eigen::Vector3f shift = ringShift(r);
    for (std::uint32_t i = 0; i < tile->size(); ++i) {
      const Moments& own = tile->own[i];
      const Eigen::Vector3f center = own.mean + shift;
      if (!isNear(center, margin_m)) continue;
      items.push_back({center, own.scatter, r == kRingCentre ? i : PointGrid::kForeign});
      for (auto& value : items.back().spread) value /= own.count;
    }
  }
  return items;
}

/// Sums of the items near the tile, added in their order.
CellSums sumCells(const std::vector<Item>& items, double cell_m, const std::vector<char>& is_chosen,
                  const Eigen::Vector3f& origin) {
  const CellKeys key(cell_m, cell_m);
  std::vector<KeyedItem> order;
  order.reserve(items.size());
  for (std::uint32_t i = 0; i < items.size(); ++i)
    if (const auto& center = items[i].center; isNear(center, cell_m))
      order.push_back({key(center.x(), center.y(), center.z()), i});
  CellSums cells;
  cells.cell_of_own.resize(is_chosen.size());
  if (order.empty()) return cells;
  sortByKey(order);
  for (const auto& entry : order) {
    const Item& item = items[entry.item];
    if (cells.key.empty() || cells.key.back() != entry.key) {
      cells.key.push_back(entry.key);
      cells.sum.emplace_back();
      cells.has_chosen.push_back(0);
    }
    cells.sum.back().addSet(item.center - origin, item.spread);
    if (item.number == PointGrid::kForeign) continue;
    cells.cell_of_own[item.number] = static_cast<std::uint32_t>(cells.key.size() - 1);
    if (is_chosen[item.number] != 0) cells.has_chosen.back() = 1;
  }
  endKeys(cells.key);
  return cells;
}

using CubeRow = std::array<float, kColumnsPerScale>;
constexpr std::size_t kShapeColumns = 6;  // followed by rise and occupied

void putShape(const EigenShape& shape, CubeRow& row) {
  const std::array<double, kShapeColumns> values{shape.linearity(),        shape.planarity(),
                                                 shape.scattering(),       std::abs(shape.normal.z()),
                                                 std::abs(shape.axis.z()), shape.length(2)};
  for (std::size_t i = 0; i < values.size(); ++i) row[i] = static_cast<float>(values[i]);
}

void putRise(const MomentSum& sum, int occupied, CubeRow& row) {
  const double mean_z = sum.z / sum.n;
  row[kShapeColumns] = static_cast<float>(std::sqrt(std::max(0.0, sum.zz / sum.n - mean_z * mean_z)));
  row[kShapeColumns + 1] = static_cast<float>(occupied) / 27.0F;
}

void fillScale(const std::vector<Item>& items, const std::vector<char>& is_chosen, const Eigen::Vector3f& origin,
               double cell_m, std::size_t column, FeatureRows& rows) {
  const CellSums cells = sumCells(items, cell_m, is_chosen, origin);
  std::vector<CubeRow> cube(cells.sum.size());
  const auto keep = [&](std::size_t cell, const EigenShape& shape) { putShape(shape, cube[cell]); };
  FourShapes four;
  NeighbourWalk walk(cells.key);
  for (std::size_t cell = 0; cell < cells.sum.size(); ++cell) {
    if (!cells.has_chosen[cell]) continue;
    walk.moveTo(cells.key[cell]);
    MomentSum sum;
    int occupied = 0;
    for (std::size_t k = 0; k < 9; ++k)
      for (std::size_t other = walk.first(k); other < walk.last(k); ++other, ++occupied) sum.addSum(cells.sum[other]);
    four.add(cell, covarianceOf(sum), keep);
    putRise(sum, occupied, cube[cell]);
  }
  four.finish(keep);
  for (std::size_t c = 0; c < is_chosen.size(); ++c) {
    if (is_chosen[c] == 0) continue;
    const auto& values = cube[cells.cell_of_own[c]];
    std::copy(values.begin(), values.end(), rows.row(c, column, kColumnsPerScale).begin());
  }
}

}  // namespace

std::vector<std::string> wideColumns() {
  std::vector<std::string> names;
  for (const char* cube : {"1m5_", "3m_"})
    for (const char* name :
         {"shape.wide_linearity", "shape.wide_planarity", "shape.wide_scattering", "shape.wide_normal_up",
          "shape.wide_axis_up", "metric.wide_rough", "metric.wide_rise", "metric.wide_occupied"}) {
      const std::string text(name);
      const auto dot = text.find("wide_");
      names.push_back(text.substr(0, dot) + "wide" + cube + text.substr(dot + 5));
    }
  return names;
}

void fillWideFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows) {
  if (input.own().size() == 0) return;
  const auto items = itemsNear(input.ring, kCells_m.back());
  std::vector<char> is_chosen(input.own().size(), 0);
  for (const std::uint32_t c : input.chosen) is_chosen[c] = 1;
  for (std::size_t scale = 0; scale < kCells_m.size(); ++scale)
    fillScale(items, is_chosen, input.own().own.front().mean, kCells_m[scale], column + scale * kColumnsPerScale, rows);
}

}  // namespace cluxel::perception
