// SPDX-License-Identifier: Apache-2.0
// Points are sorted by cube, then added up in their own order.
#include "scan/registration/voxel_thinning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/radix_order.hpp"

namespace cluxel::scan {

namespace {

using Cube = std::array<std::int32_t, 3>;

std::vector<Cube> cubesOf(const ScanPoints& points, double voxel_m) {
  const auto cubeOf = [&](float value) {
    return static_cast<std::int32_t>(std::floor(static_cast<double>(value) / voxel_m));
  };
  std::vector<Cube> cubes;
  cubes.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    cubes.push_back({cubeOf(points.x[i]), cubeOf(points.y[i]), cubeOf(points.z[i])});
  return cubes;
}

/// The numbers of the points by cube, and in a cube ascending. Sorts by z, then by x and y: a stable sort keeps z.
std::vector<std::uint32_t> orderByCube(const std::vector<Cube>& cubes) {
  Cube low{};
  if (!cubes.empty()) low = cubes.front();
  for (const Cube& cube : cubes)
    for (std::size_t axis = 0; axis < 3; ++axis) low[axis] = std::min(low[axis], cube[axis]);
  const auto above_low = [&](const Cube& cube, std::size_t axis) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(cube[axis]) - low[axis]);
  };
  std::vector<std::uint64_t> keys;
  keys.reserve(cubes.size());
  for (const Cube& cube : cubes) keys.push_back(above_low(cube, 2));
  const std::vector<std::uint32_t> by_z = cluxel::orderOf(keys);
  for (std::size_t i = 0; i < by_z.size(); ++i)
    keys[i] = above_low(cubes[by_z[i]], 0) << 32U | above_low(cubes[by_z[i]], 1);
  std::vector<std::uint32_t> order = cluxel::orderOf(keys);
  for (std::uint32_t& i : order) i = by_z[i];
  return order;
}

/// The ends of the cubes in the order.
std::vector<std::size_t> endsOf(const std::vector<Cube>& cubes, const std::vector<std::uint32_t>& order) {
  std::vector<std::size_t> ends;
  for (std::size_t i = 1; i <= order.size(); ++i)
    if (i == order.size() || cubes[order[i]] != cubes[order[i - 1]]) ends.push_back(i);
  return ends;
}

std::vector<Eigen::Vector3f> meansOf(const ScanPoints& points, const std::vector<std::uint32_t>& order,
                                     const std::vector<std::size_t>& ends) {
  std::vector<Eigen::Vector3f> means;
  means.reserve(ends.size());
  std::size_t first = 0;
  for (const std::size_t end : ends) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = first; k < end; ++k)
      sum += Eigen::Vector3d(points.x[order[k]], points.y[order[k]], points.z[order[k]]);
    means.push_back((sum / static_cast<double>(end - first)).cast<float>());
    first = end;
  }
  return means;
}

}  // namespace

std::vector<Eigen::Vector3f> thinnedToVoxels(const ScanPoints& points, const ThinningParams& params) {
  constexpr double kCoarser = 1.25;
  double voxel_m = params.voxel_m;
  for (;; voxel_m *= kCoarser) {
    const std::vector<Cube> cubes = cubesOf(points, voxel_m);
    const std::vector<std::uint32_t> order = orderByCube(cubes);
    const std::vector<std::size_t> ends = endsOf(cubes, order);
    if (ends.size() <= params.max_points) return meansOf(points, order, ends);
  }
}

}  // namespace cluxel::scan
