// SPDX-License-Identifier: Apache-2.0
// Volumes cover ALL points within reach of the seed, so that volumes of neighbours overlap and the graph has edges.
#include "perception/cover_volumes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "perception/moments.hpp"
#include "perception/radix_order.hpp"
#include "perception/vector_lanes.hpp"
#include "perception/whole_below.hpp"

namespace cluxel {
namespace {

/// Squared gaps between a place and the 9 columns of cells around it, in the order of NeighbourWalk [m2].
using ColumnGaps = std::array<float, 9>;

/// Points near a seed, with their squared distances; the arrays are reused from seed to seed.
struct NearPoints {
  std::vector<std::uint32_t> point;
  std::vector<float> squared;
  std::size_t count = 0;

  /// Takes the points within reach; columns of cells with a wider gap are not looked at.
  void collect(const PointGrid& grid, const NeighbourWalk& walk, const ColumnGaps& gaps, const Eigen::Vector3f& seed,
               float reach_squared) {
    std::array<std::array<std::uint32_t, 2>, 9> run;
    std::size_t runs = 0, total = 0;
    for (std::size_t k = 0; k < 9; ++k) {  // written first, counted if there is something in reach
      run[runs] = {grid.cell_start[walk.first(k)], grid.cell_start[walk.last(k)]};
      total += run[runs][1] - run[runs][0];
      runs +=
          static_cast<std::size_t>(run[runs][0] < run[runs][1]) & static_cast<std::size_t>(gaps[k] <= reach_squared);
    }
    count = 0;
    if (total + kLanes > point.size()) resize(2 * (total + kLanes));
    for (std::size_t r = 0; r < runs; ++r)
      for (std::uint32_t i = run[r][0]; i < run[r][1]; i += kLanes)
        addFour(grid, i, run[r][1] - i, seed, reach_squared);
  }

  std::size_t countWithin(float reach_squared) const {
    std::size_t within = 0;
    for (std::size_t n = 0; n < count; ++n) within += squared[n] <= reach_squared ? 1U : 0U;
    return within;
  }

  /// Drops the points beyond a shorter reach.
  void keepWithin(float reach_squared) {
    std::size_t kept = 0;
    for (std::size_t n = 0; n < count; ++n) {
      point[kept] = point[n];
      squared[kept] = squared[n];
      kept += squared[n] <= reach_squared ? 1U : 0U;
    }
    count = kept;
  }

 private:
  /// Takes those of the points i to i + 3 that are near and among the first `left`: written first, counted if so.
  [[gnu::always_inline]] void addFour(const PointGrid& grid, std::uint32_t i, std::uint32_t left,
                                      const Eigen::Vector3f& seed, float reach_squared) {
    const Floats dx = loadFloats(grid.x.data() + i) - seed.x(), dy = loadFloats(grid.y.data() + i) - seed.y(),
                 dz = loadFloats(grid.z.data() + i) - seed.z();
    const Floats distance = dx * dx + dy * dy + dz * dz;
    const unsigned near = lanesThatHold(distance <= reach_squared) & firstLanes(left);
    if (near == 0) return;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      point[count] = i + lane;
      squared[count] = distance[lane];
      count += near >> lane & 1U;
    }
  }

  void resize(std::size_t size) {
    point.resize(size);
    squared.resize(size);
  }
};

/// Points in the cells around.
std::size_t pointsAround(const PointGrid& grid, const NeighbourWalk& walk) {
  std::size_t sum = 0;
  for (std::size_t k = 0; k < 9; ++k) sum += grid.cell_start[walk.last(k)] - grid.cell_start[walk.first(k)];
  return sum;
}

/// Box and moments over the collected points.
void fillVolume(const PointGrid& grid, const NearPoints& near, float reach_squared, const Eigen::Vector3f& seed,
                std::size_t cluxel, CluxelTile& tile) {
  MomentSum sum;
  Eigen::Vector3f low = seed, high = seed;
  for (std::size_t n = 0; n < near.count; ++n) {
    const std::uint32_t i = near.point[n];
    const Eigen::Vector3f p(grid.x[i], grid.y[i], grid.z[i]);
    sum.add(p.x() - seed.x(), p.y() - seed.y(), p.z() - seed.z());
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  tile.volume_min[cluxel] = low;
  tile.volume_max[cluxel] = high;
  tile.ball[cluxel] = sum.finish(seed);
  tile.reach[cluxel] = std::sqrt(reach_squared);
}

/// The squared distance that holds the wanted number of points, between the two bounds; found in its bucket of
/// distances, so that few are sorted.
float grownReach(const NearPoints& near, std::size_t wanted, float least, float largest, std::vector<float>& scratch) {
  if (near.count <= wanted) return largest;
  constexpr std::size_t kBuckets = 32;
  const float scale = (static_cast<float>(kBuckets) - 0.5F) / largest;
  const auto bucketOf = [scale](float squared) { return static_cast<std::size_t>(static_cast<int>(squared * scale)); };
  std::array<std::uint32_t, kBuckets> count{};
  for (std::size_t n = 0; n < near.count; ++n) ++count[bucketOf(near.squared[n])];
  std::size_t before = 0, bucket = 0;
  while (before + count[bucket] < wanted) before += count[bucket++];
  if (scratch.size() < near.count) scratch.resize(2 * near.count);
  std::size_t found = 0;
  for (std::size_t n = 0; n < near.count; ++n) {  // written first, counted if it is one
    scratch[found] = near.squared[n];
    found += bucketOf(near.squared[n]) == bucket ? 1U : 0U;
  }
  const auto nth = scratch.begin() + static_cast<std::ptrdiff_t>(wanted - 1 - before);
  std::nth_element(scratch.begin(), nth, scratch.begin() + static_cast<std::ptrdiff_t>(found));
  return std::max(least, *nth);
}

/// Squared distances [m2].
struct Squares {
  float radius, largest;
  /// Mostly enough: half of the points within the largest reach on a surface.
  float middle() const { return std::max(radius, 0.5F * largest); }
};

/// Volumes of radius around the seeds of ascending `cluxels`; returns those that hold too few points.
std::vector<std::uint32_t> measureFixed(const PointGrid& grid, const TilePoints& points, const CellKeys& key,
                                        const Squares& squares, std::size_t wanted,
                                        const std::vector<std::uint32_t>& cluxels, CluxelTile& tile) {
  std::vector<std::uint32_t> sparse;
  NeighbourWalk walk(grid.cell_key);
  NearPoints near;
  std::uint64_t at = std::numeric_limits<std::uint64_t>::max();
  for (const std::uint32_t c : cluxels) {
    const Eigen::Vector3f seed = points.at(tile.seed[c]);
    const std::uint64_t cell = key(seed.x(), seed.y(), seed.z());
    if (cell != at) walk.moveTo(cell);
    at = cell;
    near.collect(grid, walk, ColumnGaps{}, seed, squares.radius);
    if (near.count < wanted && squares.largest > squares.radius)
      sparse.push_back(c);
    else
      fillVolume(grid, near, squares.radius, seed, c, tile);
  }
  return sparse;
}

/// `cluxels` in the order of the cells of their seeds.
std::vector<KeyedItem> byCell(const std::vector<std::uint32_t>& cluxels, const TilePoints& points, const CellKeys& key,
                              const CluxelTile& tile) {
  std::vector<KeyedItem> order;
  order.reserve(cluxels.size());
  for (const auto c : cluxels) {
    const Eigen::Vector3f seed = points.at(tile.seed[c]);
    order.push_back({key(seed.x(), seed.y(), seed.z()), c});
  }
  if (!order.empty()) sortByKey(order);
  return order;
}

/// Volumes of those of `cluxels` that are sparse, in the order of the wide cells; returns the others, ascending. Where
/// more than `crowd` points lie in the cells around, a cluxel is taken for another without a look.
std::vector<std::uint32_t> measureGrown(const PointGrid& grid, const TilePoints& points, const CellKeys& key,
                                        const Squares& squares, std::size_t wanted, std::size_t crowd,
                                        const std::vector<std::uint32_t>& cluxels, CluxelTile& tile) {
  std::vector<std::uint32_t> others;
  NeighbourWalk walk(grid.cell_key);
  NearPoints near;
  std::vector<float> scratch;
  std::uint64_t at = std::numeric_limits<std::uint64_t>::max();
  bool is_crowded = false;
  for (const auto& [cell, c] : byCell(cluxels, points, key, tile)) {
    if (cell != at) {
      walk.moveTo(cell);
      is_crowded = pointsAround(grid, walk) > crowd;
      at = cell;
    }
    const Eigen::Vector3f seed = points.at(tile.seed[c]);
    const ColumnGaps gaps = key.gapsAround(seed.x(), seed.y());
    if (!is_crowded) near.collect(grid, walk, gaps, seed, squares.middle());
    if (is_crowded || near.countWithin(squares.radius) >= wanted) {
      others.push_back(c);
      continue;
    }
    if (near.count <= wanted) near.collect(grid, walk, gaps, seed, squares.largest);
    const float reach_squared = grownReach(near, wanted, squares.radius, squares.largest, scratch);
    near.keepWithin(reach_squared);
    fillVolume(grid, near, reach_squared, seed, c, tile);
  }
  std::sort(others.begin(), others.end());
  return others;
}

/// Height of the layer above a column's lowest point whose mean is its `low` [m].
constexpr float kLowLayer_m = 0.1F;

std::size_t columnOf(float x, float y) {
  constexpr auto per_m = static_cast<float>(1.0 / kColumnSize_m);
  return static_cast<std::size_t>(y * per_m) * kColumnsPerTile + static_cast<std::size_t>(x * per_m);
}

std::int32_t sliceOf(float z) {
  return static_cast<std::int32_t>(wholeBelow(z / kSliceHeight_m));
}

}  // namespace

void measureVolumes(const PointGrid& cells, const PointGrid& wide_cells, const TilePoints& points,
                    const CoverParams& params, CluxelTile& tile) {
  tile.volume_min.resize(tile.size());
  tile.volume_max.resize(tile.size());
  tile.ball.resize(tile.size());
  tile.reach.resize(tile.size());
  const double largest_m = std::max(params.radius_m, params.largest_reach_m);
  const auto squareOf = [](double value_m) { return static_cast<float>(value_m) * static_cast<float>(value_m); };
  const Squares squares{squareOf(params.radius_m), squareOf(largest_m)};
  const auto wanted = static_cast<std::size_t>(params.wanted_points);
  const CellKeys key(params.radius_m, params.radius_m), wide_key(largest_m, largest_m);
  std::vector<std::uint32_t> left(tile.size());
  std::iota(left.begin(), left.end(), 0U);
  // Most cluxels are sparse, which the wide cells show, too: only the others need the narrow ones. Of a surface's
  // points in the wide cells around, one in 25 is within the usual radius: where so many lie there, to look at all
  // would be in vain.
  const std::size_t crowd = 32 * wanted;
  if (squares.largest > squares.radius)
    left = measureGrown(wide_cells, points, wide_key, squares, wanted, crowd, left, tile);
  left = measureFixed(cells, points, key, squares, wanted, left, tile);
  measureGrown(wide_cells, points, wide_key, squares, wanted, std::numeric_limits<std::size_t>::max(), left, tile);
}

std::vector<Column> columnsOf(const TilePoints& points) {
  std::vector<Column> columns(static_cast<std::size_t>(kColumnsPerTile) * kColumnsPerTile);
  std::vector<float> lowest(columns.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t c = columnOf(points.x[i], points.y[i]);
    Column& column = columns[c];
    const float z = points.z[i];
    lowest[c] = column.count == 0 ? z : std::min(lowest[c], z);
    column.high = column.count == 0 ? z : std::max(column.high, z);
    ++column.count;
  }
  std::vector<double> sum(columns.size());
  std::vector<std::uint32_t> low_count(columns.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t c = columnOf(points.x[i], points.y[i]);
    const std::int32_t base = sliceOf(lowest[c]);
    columns[c].base_slice = base;
    columns[c].slices |= std::uint64_t{1} << static_cast<unsigned>(std::min(63, sliceOf(points.z[i]) - base));
    if (points.z[i] > lowest[c] + kLowLayer_m) continue;
    sum[c] += points.z[i];
    ++low_count[c];
  }
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (columns[c].count > 0) columns[c].low = static_cast<float>(sum[c] / low_count[c]);
  return columns;
}

}  // namespace cluxel
