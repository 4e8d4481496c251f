// SPDX-License-Identifier: Apache-2.0
// Sums of points and of products of their deviations, in double and relative to an origin near them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "perception/clustering/cluxel_tile.hpp"
#include "perception/clustering/local_steps.hpp"

namespace cluxel::perception {

/// Sums over points given relative to one origin.
struct MomentSum {
  double n = 0, x = 0, y = 0, z = 0;
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  void add(double dx, double dy, double dz) {
    n += 1;
    x += dx;
    y += dy;
    z += dz;
    xx += dx * dx;
    xy += dx * dy;
    xz += dx * dz;
    yy += dy * dy;
    yz += dy * dz;
    zz += dz * dz;
  }

  /// Adds a set of weight 1 with this mean (relative to the origin) and these mean products of deviations.
  void addSet(const Eigen::Vector3f& mean, const std::array<float, 6>& spread) {
    add(mean.x(), mean.y(), mean.z());
    xx += spread[0];
    xy += spread[1];
    xz += spread[2];
    yy += spread[3];
    yz += spread[4];
    zz += spread[5];
  }

  /// Adds a sum relative to the same origin.
  void addSum(const MomentSum& other) {
    n += other.n;
    x += other.x;
    y += other.y;
    z += other.z;
    xx += other.xx;
    xy += other.xy;
    xz += other.xz;
    yy += other.yy;
    yz += other.yz;
    zz += other.zz;
  }

  /// The stored form, with the mean in the tile's coordinates. `origin`: position of the origin in the tile.
  Moments finish(const Eigen::Vector3f& origin) const {
    const double mx = x / n, my = y / n, mz = z / n;
    const auto part = [](double value) { return static_cast<float>(value); };
    return {part(n),
            {toLocalStep(origin.x() + mx), toLocalStep(origin.y() + my), toHeightStep(origin.z() + mz)},
            {part(std::max(0.0, xx - x * mx)), part(xy - x * my), part(xz - x * mz), part(std::max(0.0, yy - y * my)),
             part(yz - y * mz), part(std::max(0.0, zz - z * mz))}};
  }
};

}  // namespace cluxel::perception
