// SPDX-License-Identifier: Apache-2.0
// Bounding volumes hold all points within reach of the seed, so that volumes of neighbours overlap and the graph has
// edges.
#include "perception/clustering/cluxel_volumes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/radix_order.hpp"
#include "perception/clustering/fast_floor.hpp"
#include "perception/clustering/local_steps.hpp"
#include "perception/moments.hpp"
#include "perception/simd_vector.hpp"

namespace cluxel::perception {
namespace {

/// Squared distances from a position to the 9 cell stacks around it, in the order of NeighbourWalk [m2].
using StackGaps = std::array<float, 9>;

/// Points near a seed with their squared distances. The arrays are reused for all seeds.
struct NearPoints {
  std::vector<std::uint32_t> point;
  std::vector<float> squared;
  std::size_t count = 0;

  /// Collects the points within reach; skips cell stacks that are farther away.
  void collect(const PointGrid& grid, const NeighbourWalk& walk, const StackGaps& gaps, const Eigen::Vector3f& seed,
               float reach_squared) {
    std::array<std::array<std::uint32_t, 2>, 9> run;
    std::size_t runs = 0, total = 0;
    for (std::size_t k = 0; k < 9; ++k) {  // branchless append
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
  /// Branchless append of those of the points i to i + 3 that are within reach and among the first `left`.
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

/// The number of points in the neighbouring cells.
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

/// The squared distance within which the target number of points lie, clamped to the two bounds. Distances are counted
/// in buckets first, so that only one bucket needs a selection.
float grownReach(const NearPoints& near, std::size_t target_points, float min_reach, float largest,
                 std::vector<float>& scratch) {
  if (near.count <= target_points) return largest;
  constexpr std::size_t kBuckets = 32;
  const float scale = (static_cast<float>(kBuckets) - 0.5F) / largest;
  const auto bucketOf = [scale](float squared) { return static_cast<std::size_t>(static_cast<int>(squared * scale)); };
  std::array<std::uint32_t, kBuckets> count{};
  for (std::size_t n = 0; n < near.count; ++n) ++count[bucketOf(near.squared[n])];
  std::size_t before = 0, bucket = 0;
  while (before + count[bucket] < target_points) before += count[bucket++];
  if (scratch.size() < near.count) scratch.resize(2 * near.count);
  std::size_t found = 0;
  for (std::size_t n = 0; n < near.count; ++n) {  // branchless append
    scratch[found] = near.squared[n];
    found += bucketOf(near.squared[n]) == bucket ? 1U : 0U;
  }
  const auto nth = scratch.begin() + static_cast<std::ptrdiff_t>(target_points - 1 - before);
  std::nth_element(scratch.begin(), nth, scratch.begin() + static_cast<std::ptrdiff_t>(found));
  return std::max(min_reach, *nth);
}

/// Squared distances [m2].
struct Squares {
  float radius, largest;
  /// Usually large enough: on a surface it holds half of the points within the largest reach.
  float middle() const { return std::max(radius, 0.5F * largest); }
};

/// Volumes with the fixed radius for the cluxels of `cluxels` (ascending); returns those that hold too few points.
std::vector<std::uint32_t> measureFixed(const PointGrid& grid, const TilePoints& points, const CellKeys& key,
                                        const Squares& squares, std::size_t target_points,
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
    near.collect(grid, walk, StackGaps{}, seed, squares.radius);
    if (near.count < target_points && squares.largest > squares.radius)
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

/// Volumes of the sparse ones among `cluxels`, in the order of the wide cells; returns the others, ascending. A cluxel
/// with more than `crowd` points in the neighbouring cells counts as dense without computing distances.
std::vector<std::uint32_t> measureGrown(const PointGrid& grid, const TilePoints& points, const CellKeys& key,
                                        const Squares& squares, std::size_t target_points, std::size_t crowd,
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
    const StackGaps gaps = key.gapsAround(seed.x(), seed.y());
    if (!is_crowded) near.collect(grid, walk, gaps, seed, squares.middle());
    if (is_crowded || near.countWithin(squares.radius) >= target_points) {
      others.push_back(c);
      continue;
    }
    if (near.count <= target_points) near.collect(grid, walk, gaps, seed, squares.largest);
    const float reach_squared = grownReach(near, target_points, squares.radius, squares.largest, scratch);
    near.keepWithin(reach_squared);
    fillVolume(grid, near, reach_squared, seed, c, tile);
  }
  std::sort(others.begin(), others.end());
  return others;
}

/// `low` of a stack is the mean of the points up to this height above the lowest one [m].
constexpr float kLowLayer_m = 0.1F;

std::size_t stackOf(float x, float y) {
  constexpr auto per_m = static_cast<float>(1.0 / kStackSize_m);
  return static_cast<std::size_t>(y * per_m) * kStacksPerTile + static_cast<std::size_t>(x * per_m);
}

std::int32_t sliceOf(float z) {
  return static_cast<std::int32_t>(fastFloor(z / kSliceHeight_m));
}

}  // namespace

void measureVolumes(const PointGrid& cells, const PointGrid& wide_cells, const TilePoints& points,
                    const ClusterParams& params, std::vector<std::uint32_t> chosen, CluxelTile& tile) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  tile.volume_min.assign(tile.size(), Eigen::Vector3f::Constant(kInfinity));
  tile.volume_max.assign(tile.size(), Eigen::Vector3f::Constant(-kInfinity));
  tile.ball.assign(tile.size(), {});
  tile.reach.assign(tile.size(), 0.0F);
  const double largest_m = std::max(params.radius_m, params.max_reach_m);
  const auto squareOf = [](double value_m) { return static_cast<float>(value_m) * static_cast<float>(value_m); };
  const Squares squares{squareOf(params.radius_m), squareOf(largest_m)};
  const auto target_points = static_cast<std::size_t>(params.target_points);
  const CellKeys key(params.radius_m, params.radius_m), wide_key(largest_m, largest_m);
  std::vector<std::uint32_t> left = std::move(chosen);
  // Most cluxels are sparse, and the wide cells suffice for them; only the others need the narrow cells. On a surface,
  // 1 in 25 of the points in the neighbouring wide cells is within the radius, so a crowded neighbourhood is dense.
  const std::size_t crowd = 32 * target_points;
  if (squares.largest > squares.radius)
    left = measureGrown(wide_cells, points, wide_key, squares, target_points, crowd, left, tile);
  left = measureFixed(cells, points, key, squares, target_points, left, tile);
  measureGrown(wide_cells, points, wide_key, squares, target_points, std::numeric_limits<std::size_t>::max(), left,
               tile);
}

std::vector<CellStack> stacksOf(const TilePoints& points) {
  std::vector<CellStack> stacks(static_cast<std::size_t>(kStacksPerTile) * kStacksPerTile);
  std::vector<float> lowest(stacks.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t c = stackOf(points.x[i], points.y[i]);
    CellStack& stack = stacks[c];
    const float z = points.z[i];
    lowest[c] = stack.count == 0 ? z : std::min(lowest[c], z);
    stack.high = stack.count == 0 ? z : std::max(stack.high, z);
    ++stack.count;
  }
  std::vector<double> sum(stacks.size());
  std::vector<std::uint32_t> low_count(stacks.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t c = stackOf(points.x[i], points.y[i]);
    const std::int32_t base = sliceOf(lowest[c]);
    stacks[c].base_slice = base;
    stacks[c].slices |= std::uint64_t{1} << static_cast<unsigned>(std::min(63, sliceOf(points.z[i]) - base));
    if (points.z[i] - lowest[c] > kLowLayer_m) continue;  // exact, however high the points are
    sum[c] += points.z[i];
    ++low_count[c];
  }
  for (std::size_t c = 0; c < stacks.size(); ++c)
    if (stacks[c].count > 0) stacks[c].low = toHeightStep(sum[c] / low_count[c]);
  return stacks;
}

}  // namespace cluxel::perception
