// SPDX-License-Identifier: Apache-2.0
// Sums of points and of products of their deviations, in double and relative to an origin near them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "cluxel/perception/cluxel_tile.hpp"

namespace cluxel {

/// Rounded down to the step of local coordinates, so that shifts to a neighbouring tile stay exact.
inline float toLocalStep(double value_m) {
  return static_cast<float>(std::floor(value_m / kLocalStep_m) * kLocalStep_m);
}

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

  /// Adds `weight` times a set with this mean (relative to the origin) and this mean product of deviations.
  void addSet(double weight, const Eigen::Vector3f& d, const std::array<float, 6>& scatter, double per_point) {
    const double dx = d.x(), dy = d.y(), dz = d.z();
    n += weight;
    x += weight * dx;
    y += weight * dy;
    z += weight * dz;
    xx += weight * (dx * dx + per_point * scatter[0]);
    xy += weight * (dx * dy + per_point * scatter[1]);
    xz += weight * (dx * dz + per_point * scatter[2]);
    yy += weight * (dy * dy + per_point * scatter[3]);
    yz += weight * (dy * dz + per_point * scatter[4]);
    zz += weight * (dz * dz + per_point * scatter[5]);
  }

  /// As stored: mean in the tile's coordinates, given the origin's place there.
  Moments finish(const Eigen::Vector3f& origin) const {
    const double mx = x / n, my = y / n, mz = z / n;
    const auto part = [](double value) { return static_cast<float>(value); };
    return {part(n),
            {toLocalStep(origin.x() + mx), toLocalStep(origin.y() + my), part(origin.z() + mz)},
            {part(std::max(0.0, xx - x * mx)), part(xy - x * my), part(xz - x * mz),
             part(std::max(0.0, yy - y * my)), part(yz - y * mz), part(std::max(0.0, zz - z * mz))}};
  }
};

}  // namespace cluxel
