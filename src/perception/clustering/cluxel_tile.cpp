// SPDX-License-Identifier: Apache-2.0
// Clustering in one pass over the sorted cells: only earlier cells can hold earlier seeds.
#include "perception/clustering/cluxel_tile.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/free_memory.hpp"
#include "perception/clustering/cluxel_volumes.hpp"
#include "perception/clustering/point_grid.hpp"
#include "perception/moments.hpp"
#include "perception/simd_vector.hpp"

namespace cluxel::perception {
namespace {

/// Seeds found so far. Their numbers ascend with their cells, so a range of cells holds a range of seeds.
struct Seeds {
  std::vector<float> x, y, z;         ///< padded: a whole SIMD vector may be read from any element
  std::vector<std::uint32_t> before;  ///< per cell: seeds in earlier cells
  std::uint32_t count = 0;

  Seeds(std::size_t max_seeds, std::size_t cells)
      : x(max_seeds + kLanes), y(max_seeds + kLanes), z(max_seeds + kLanes), before(cells + 1) {}
  void add(float px, float py, float pz) {
    x[count] = px;
    y[count] = py;
    z[count++] = pz;
  }
};

/// Ascending ranges of the seeds that lie in a cell and in the neighbouring cells before it.
struct SeedRuns {
  std::array<std::array<std::uint32_t, 2>, 5> run;
  std::size_t count = 0;  ///< non-empty ranges of earlier cells; the range of the cell itself follows them

  void moveTo(const Seeds& seeds, const NeighbourWalk& walk, std::size_t cell) {
    count = 0;
    for (std::size_t k = 0; k < run.size(); ++k) {
      run[count] = {seeds.before[std::min(walk.first(k), cell)], seeds.before[std::min(walk.last(k), cell)]};
      count += k + 1 < run.size() && run[count][0] < run[count][1] ? 1U : 0U;
    }
  }
};

/// The first seed within the radius of the point, or the number of seeds. Compares four seeds at a time.
std::uint32_t earliestSeed(const Seeds& seeds, const SeedRuns& runs, float x, float y, float z, float squared) {
  for (std::size_t r = 0; r <= runs.count; ++r) {
    const std::uint32_t last = r < runs.count ? runs.run[r][1] : seeds.count;
    for (std::uint32_t seed = runs.run[r][0]; seed < last; seed += kLanes) {
      const Floats dx = loadFloats(&seeds.x[seed]) - x, dy = loadFloats(&seeds.y[seed]) - y,
                   dz = loadFloats(&seeds.z[seed]) - z;
      const unsigned near = lanesThatHold(dx * dx + dy * dy + dz * dz <= squared) & firstLanes(last - seed);
      if (near != 0) return seed + static_cast<std::uint32_t>(std::countr_zero(near));
    }
  }
  return seeds.count;
}

/// Gives each own point its cluxel; cells are visited in canonical order.
void assignPoints(const PointGrid& grid, float radius_m, CluxelTile& tile) {
  Seeds seeds(tile.point_cluxel.size(), grid.cells());
  NeighbourWalk walk(grid.cell_key);
  SeedRuns runs;
  for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
    seeds.before[cell] = seeds.count;
    walk.moveTo<NeighbourWalk::kEarlier>(grid.cell_key[cell]);
    runs.moveTo(seeds, walk, cell);
    for (std::uint32_t i = grid.cell_start[cell]; i < grid.cell_start[cell + 1]; ++i) {
      if (grid.own[i] == PointGrid::kForeign) continue;
      const float x = grid.x[i], y = grid.y[i], z = grid.z[i];
      const std::uint32_t seed = earliestSeed(seeds, runs, x, y, z, radius_m * radius_m);
      tile.point_cluxel[grid.own[i]] = seed;
      if (seed < seeds.count) continue;
      tile.seed.push_back(grid.own[i]);
      seeds.add(x, y, z);
    }
  }
}

/// Moments and box of each cluxel's own points, relative to its seed.
void measureOwnPoints(const TilePoints& points, CluxelTile& tile) {
  std::vector<MomentSum> sums(tile.size());
  tile.box_min.resize(tile.size());
  tile.box_max.resize(tile.size());
  for (std::size_t c = 0; c < tile.size(); ++c) tile.box_min[c] = tile.box_max[c] = points.at(tile.seed[c]);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t c = tile.point_cluxel[i];
    const Eigen::Vector3f p = points.at(i);
    const Eigen::Vector3f d = p - points.at(tile.seed[c]);
    sums[c].add(d.x(), d.y(), d.z());
    tile.box_min[c] = tile.box_min[c].cwiseMin(p);
    tile.box_max[c] = tile.box_max[c].cwiseMax(p);
  }
  tile.own.resize(tile.size());
  for (std::size_t c = 0; c < tile.size(); ++c) tile.own[c] = sums[c].finish(points.at(tile.seed[c]));
}

void measureIntensity(const TilePoints& points, CluxelTile& tile) {
  if (points.intensity.empty()) return;
  std::vector<double> sum(tile.size()), squares(tile.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum[tile.point_cluxel[i]] += points.intensity[i];
    squares[tile.point_cluxel[i]] += double{points.intensity[i]} * points.intensity[i];
  }
  tile.intensity_mean.resize(tile.size());
  tile.intensity_deviation.resize(tile.size());
  for (std::size_t c = 0; c < tile.size(); ++c) {
    const double mean = sum[c] / tile.own[c].count;
    tile.intensity_mean[c] = static_cast<float>(mean);
    tile.intensity_deviation[c] =
        static_cast<float>(std::sqrt(std::max(0.0, squares[c] / tile.own[c].count - mean * mean)));
  }
}

std::vector<std::uint32_t> allOf(const CluxelTile& tile) {
  std::vector<std::uint32_t> all(tile.size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

PointGrid wideGrid(const Ring<TilePoints>& ring, const ClusterParams& params) {
  const double largest_m = std::max(params.radius_m, params.max_reach_m);
  return gridOf(ring, largest_m, largest_m);
}

}  // namespace

void describe(ClusterParams& params, ParameterVisitor& visitor) {
  visitor.real({"clustering.radius", "m", 0.05, 1.0, "a point joins the earliest seed within this distance"},
               params.radius_m);
  visitor.real({"clustering.max_reach", "m", 0.05, kMaxReach_m, "how far volumes of sparse cluxels may grow"},
               params.max_reach_m);
  visitor.whole({"clustering.target_points", "1", 1, 1000, "a volume grows until it holds this many points"},
                params.target_points);
}

void measureOwn(const TilePoints& points, CluxelTile& tile) {
  measureOwnPoints(points, tile);
  measureIntensity(points, tile);
  tile.stacks = stacksOf(points);
}

CluxelTile clusterTile(const Ring<TilePoints>& ring, const ClusterParams& params) {
  const TilePoints& points = *ring[kRingCentre];
  const PointGrid cells = gridOf(ring, params.radius_m, params.radius_m);
  CluxelTile tile;
  tile.key = points.key;
  tile.point_cluxel.resize(points.size());
  assignPoints(cells, static_cast<float>(params.radius_m), tile);
  measureOwn(points, tile);
  measureVolumes(cells, wideGrid(ring, params), points, params, allOf(tile), tile);
  return tile;
}

void addVolumes(const Ring<TilePoints>& ring, const ClusterParams& params, std::vector<std::uint32_t> chosen,
                CluxelTile& tile) {
  measureVolumes(gridOf(ring, params.radius_m, params.radius_m), wideGrid(ring, params), *ring[kRingCentre], params,
                 std::move(chosen), tile);
}

void dropVolumes(CluxelTile& tile) {
  freeMemory(tile.volume_min, tile.volume_max, tile.ball, tile.reach);
}

}  // namespace cluxel::perception
