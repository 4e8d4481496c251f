// SPDX-License-Identifier: Apache-2.0
// Points are sorted by the key of their cube, then added up in their own order.
#include "scan/registration/voxel_thinning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace cluxel::scan {

namespace {

struct KeyedPoint {
  std::array<std::int32_t, 3> cube;
  std::uint32_t index;
  auto operator<=>(const KeyedPoint&) const = default;
};

std::vector<KeyedPoint> keyed(const ScanPoints& points, double voxel_m) {
  const auto cubeOf = [&](float value) {
    return static_cast<std::int32_t>(std::floor(static_cast<double>(value) / voxel_m));
  };
  std::vector<KeyedPoint> keys;
  keys.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    keys.push_back({{cubeOf(points.x[i]), cubeOf(points.y[i]), cubeOf(points.z[i])}, static_cast<std::uint32_t>(i)});
  std::sort(keys.begin(), keys.end());
  return keys;
}

std::vector<Eigen::Vector3f> meansOfCubes(const ScanPoints& points, const std::vector<KeyedPoint>& keys) {
  std::vector<Eigen::Vector3f> means;
  for (std::size_t first = 0, last = 0; first < keys.size(); first = last) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (; last < keys.size() && keys[last].cube == keys[first].cube; ++last) {
      const std::uint32_t i = keys[last].index;
      sum += Eigen::Vector3d(points.x[i], points.y[i], points.z[i]);
    }
    means.push_back((sum / static_cast<double>(last - first)).cast<float>());
  }
  return means;
}

}  // namespace

std::vector<Eigen::Vector3f> thinnedToVoxels(const ScanPoints& points, const ThinningParams& params) {
  constexpr double kCoarser = 1.25;
  double voxel_m = params.voxel_m;
  for (;; voxel_m *= kCoarser) {
    std::vector<Eigen::Vector3f> means = meansOfCubes(points, keyed(points, voxel_m));
    if (means.size() <= params.max_points) return means;
  }
}

}  // namespace cluxel::scan
