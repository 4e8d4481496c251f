// SPDX-License-Identifier: Apache-2.0
// Rays from one place, indexed by direction.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

namespace cluxel::perception {

class DirectionIndex {
 public:
  /// Cells of half a degree.
  static constexpr int kFineRows = 360;

  /// `ends` are the ends of the rays relative to the place where they start [m]. `rows`: cells of direction from the
  /// nadir to the zenith; there are twice as many around. Cost: linear in the rays and cells.
  explicit DirectionIndex(std::vector<Eigen::Vector3f> ends, int rows = kFineRows);

  /// Sorted by direction.
  std::span<const Eigen::Vector3f> rays() const { return rays_; }

  /// Calls `visit(end, range_m, along_m)` for each ray that passes within `near_m` of a place, or would if it were
  /// longer: its range, and where on it the place is nearest. `place` is relative to the start of the rays.
  template <typename Visit>
  void forEachNear(const Eigen::Vector3d& place, double near_m, Visit&& visit) const {
    const Window window = windowAround(place, near_m);
    const double aside_limit = place.squaredNorm() - near_m * near_m;
    for (int row = window.low_row; row <= window.high_row; ++row)
      for (int column = window.low_column; column < window.low_column + window.columns; ++column)
        for (const Eigen::Vector3f& ray : raysIn(row, column)) {
          const Eigen::Vector3d end = ray.cast<double>();
          const double range_squared = end.squaredNorm(), product = place.dot(end);
          if (product <= 0 || product * product < aside_limit * range_squared) continue;
          const double range_m = std::sqrt(range_squared);
          visit(end, range_m, product / range_m);
        }
  }

  /// The ends of the nearest rays below a place: those of the first cells of direction downwards, in the columns of its
  /// surroundings, until there are `count` of them. Fewer when there are no more.
  std::vector<Eigen::Vector3f> nearestBelow(const Eigen::Vector3d& place, double near_m, std::size_t count) const;

 private:
  /// Cells of direction. Columns may exceed the range: they wrap around.
  struct Window {
    int low_row = 0, high_row = 0, low_column = 0, columns = 0;
  };
  Window windowAround(const Eigen::Vector3d& place, double near_m) const;
  int rowOf(double elevation) const;
  int columnOf(double azimuth) const;
  std::size_t cellOf(int row, int column) const;  ///< columns wrap around
  std::span<const Eigen::Vector3f> raysIn(int row, int column) const;

  int rows_;
  std::vector<std::uint32_t> first_;   ///< of each cell of direction in rays_; cells row by row in elevation
  std::vector<Eigen::Vector3f> rays_;  ///< sorted by cell
};

}  // namespace cluxel::perception
