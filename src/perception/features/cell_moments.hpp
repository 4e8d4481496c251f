// SPDX-License-Identifier: Apache-2.0
// Sums over points from which the plane through them follows.
#pragma once

#include <algorithm>

namespace cluxel::perception {

/// Sums over points, from an origin near them [m].
struct CellMoments {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;

  void add(double px, double py, double pz, double weight = 1) {
    n += weight, x += weight * px, y += weight * py, z += weight * pz;
    xx += weight * px * px, xy += weight * px * py, yy += weight * py * py;
    xz += weight * px * pz, yz += weight * py * pz, zz += weight * pz * pz;
  }
  void add(const CellMoments& o) {
    n += o.n, x += o.x, y += o.y, z += o.z, xx += o.xx, xy += o.xy, yy += o.yy, xz += o.xz, yz += o.yz, zz += o.zz;
  }
  /// About the means.
  CellMoments centred() const {
    const double mx = x / n, my = y / n, mz = z / n;
    return {n,
            0,
            0,
            0,
            xx - n * mx * mx,
            xy - n * mx * my,
            yy - n * my * my,
            xz - n * mx * mz,
            yz - n * my * mz,
            zz - n * mz * mz};
  }
  /// Of centred moments, the sum of squares of z - a x - b y.
  double residual(double a, double b) const {
    return std::max(0.0, zz - 2 * (a * xz + b * yz) + a * a * xx + 2 * a * b * xy + b * b * yy);
  }
};

}  // namespace cluxel::perception
