// SPDX-License-Identifier: Apache-2.0
// Nearest-neighbour search within a short radius, by a grid of vertical cell stacks instead of a tree.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace cluxel::scan {

/// Points in vertical cell stacks, each sorted by height. A search is thread-safe and takes about 0.3 µs for thinned
/// scans.
class NearestGrid {
 public:
  /// `max_reach_m` bounds the reach of all searches.
  NearestGrid(const std::vector<Eigen::Vector3f>& points, double max_reach_m);

  /// The number of the point nearest to `p`, when one is within `reach_m`; of equally near ones the one that comes
  /// first.
  std::optional<std::size_t> nearest(const Eigen::Vector3d& p, double reach_m) const;

 private:
  struct Entry {
    float z, x, y;
    std::uint32_t index;
  };
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  double cell_m_ = 1;
  std::int64_t columns_x_ = 0, columns_y_ = 0;
  std::vector<std::uint32_t> first_;  ///< per cell stack, and one more
  std::vector<Entry> entries_;
};

}  // namespace cluxel::scan
