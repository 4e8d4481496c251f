// SPDX-License-Identifier: Apache-2.0
// A grid in plan view over the cluxels of a scene, for distance queries.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "perception/segments/scene.hpp"

namespace cluxel::rules {

/// Distances between the boxes of two cluxels [m].
struct CluxelGap {
  double horizontal = 0, vertical = 0;
  double gap() const { return std::sqrt(horizontal * horizontal + vertical * vertical); }
};
inline CluxelGap gapBetween(const perception::SceneCluxels& all, std::uint32_t a, std::uint32_t b) {
  const Eigen::Vector3d half = (all.extent[a] + all.extent[b]).cast<double>() / 2;
  const Eigen::Vector3d apart = ((all.center[a] - all.center[b]).cwiseAbs() - half).cwiseMax(0);
  return {std::sqrt(apart.x() * apart.x() + apart.y() * apart.y()), apart.z()};
}

class CluxelGrid {
 public:
  explicit CluxelGrid(const perception::SceneCluxels& all);

  /// Calls `visit` for every cluxel whose box may be within `distance_m` of the box of `cluxel`, in plan view.
  template <typename Visit>
  void near(std::uint32_t cluxel, double distance_m, const Visit& visit) const {
    const Eigen::Vector3d& centre = all_.center[cluxel];
    const double own = static_cast<double>(all_.extent[cluxel].head<2>().maxCoeff()) / 2;
    const double reach = distance_m + margin_m_ + own;
    const std::int32_t low_y = cellOf(centre.y() - reach), high_y = cellOf(centre.y() + reach);
    for (std::int32_t x = cellOf(centre.x() - reach); x <= cellOf(centre.x() + reach); ++x) {
      const auto [first, last] = row(x, low_y, high_y);
      for (std::uint32_t i = first; i < last; ++i) visit(cluxels_[i]);
    }
  }
  /// The primitives with a cluxel whose box may be within `distance_m` of one of `cluxels`; ascending.
  std::vector<perception::PrimitiveIndex> primitivesNear(std::span<const std::uint32_t> cluxels,
                                                         double distance_m) const;

 private:
  static constexpr double kCell_m = 1.0;
  struct Cell {
    std::int32_t x, y;
    std::uint32_t first;  ///< its first place in cluxels_; the next cell's first is its end
  };

  static std::int32_t cellOf(double coordinate_m) {
    return static_cast<std::int32_t>(std::floor(coordinate_m / kCell_m));
  }
  /// The range in cluxels_ of the cells (x, low_y) to (x, high_y).
  std::pair<std::uint32_t, std::uint32_t> row(std::int32_t x, std::int32_t low_y, std::int32_t high_y) const;

  const perception::SceneCluxels& all_;
  double margin_m_ = 0;                 ///< half of the largest cluxel box in plan view
  std::vector<Cell> cells_;             ///< ordered by x, then y; the last one is a sentinel
  std::vector<std::uint32_t> cluxels_;  ///< by cell, then ascending
};

}  // namespace cluxel::rules
