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

/// The box around the boxes of cluxels [m, map].
inline Eigen::AlignedBox3d boxAround(const perception::SceneCluxels& all, std::span<const std::uint32_t> cluxels) {
  Eigen::AlignedBox3d box;
  for (const std::uint32_t cluxel : cluxels) {
    const Eigen::Vector3d half = all.extent[cluxel].cast<double>() / 2;
    box.extend(all.center[cluxel] - half);
    box.extend(all.center[cluxel] + half);
  }
  return box;
}

class CluxelGrid {
 public:
  explicit CluxelGrid(const perception::SceneCluxels& all);
  /// A grid over some of them, without primitivesNear(). Any cluxel may be asked about.
  CluxelGrid(const perception::SceneCluxels& all, std::span<const std::uint32_t> some);

  /// Calls `visit` for every cluxel whose box may be within `distance_m` of the box of `cluxel`.
  template <typename Visit>
  void near(std::uint32_t cluxel, double distance_m, const Visit& visit) const {
    search(cluxel, distance_m, true, visit);
  }
  /// The same with distances in plan view.
  template <typename Visit>
  void nearInPlan(std::uint32_t cluxel, double distance_m, const Visit& visit) const {
    search(cluxel, distance_m, false, visit);
  }
  /// Cells up to this far beyond a distance are looked at by primitivesNear() [m].
  double slack_m() const { return 2 * margin_m_ + 2 * kCell_m; }
  /// The primitives with a cluxel whose box may be within `distance_m` of one of `cluxels`; ascending.
  std::vector<perception::PrimitiveIndex> primitivesNear(std::span<const std::uint32_t> cluxels,
                                                         double distance_m) const;

 private:
  static constexpr double kCell_m = 1.0;
  struct Cell {
    std::int32_t x, y;
    std::uint32_t first;  ///< its first place in entries_; the next cell's first is its end
  };
  struct Entry {
    float z = 0;  ///< of the centre, above origin_z_
    std::uint32_t cluxel = 0;
  };
  float heightOf(std::uint32_t cluxel) const { return static_cast<float>(all_.center[cluxel].z() - origin_z_); }

  template <typename Visit>
  void search(std::uint32_t cluxel, double distance_m, bool with_height, const Visit& visit) const {
    const Eigen::Vector3d& centre = all_.center[cluxel];
    const Eigen::Vector3f half = all_.extent[cluxel] / 2;
    const float z = heightOf(cluxel), far_z = static_cast<float>(distance_m) + half.z() + tallest_half_m_ + rounding_m_;
    const double reach = distance_m + margin_m_ + static_cast<double>(half.head<2>().maxCoeff());
    forEachCell(centre.head<2>(), reach, [&](std::uint32_t i, std::uint32_t last) {
      if (with_height && entries_[i].z < z - far_z) i = firstAbove(i, last, z - far_z);
      for (; i < last && !(with_height && entries_[i].z > z + far_z); ++i) visit(entries_[i].cluxel);
    });
  }

  /// Calls `visit(first, last)` with the entries of each cell that is within `reach` in plan view.
  template <typename Visit>
  void forEachCell(const Eigen::Vector2d& centre, double reach, const Visit& visit) const {
    const std::int32_t low_y = cellOf(centre.y() - reach), high_y = cellOf(centre.y() + reach);
    for (std::int32_t x = cellOf(centre.x() - reach); x <= cellOf(centre.x() + reach); ++x) {
      const auto [cell, end] = row(x, low_y, high_y);
      for (std::uint32_t i = cell; i < end; ++i) visit(cells_[i].first, cells_[i + 1].first);
    }
  }
  /// The first of the entries of a cell that are no lower than `z`.
  std::uint32_t firstAbove(std::uint32_t first, std::uint32_t last, float z) const {
    const auto begin = entries_.begin();
    const auto found =
        std::lower_bound(begin + first, begin + last, z, [](const Entry& entry, float low) { return entry.z < low; });
    return static_cast<std::uint32_t>(found - begin);
  }

  std::vector<std::uint32_t> inCellOrder(std::span<const std::uint32_t> some) const;
  void listPrimitives();
  static std::int32_t cellOf(double coordinate_m) {
    return static_cast<std::int32_t>(std::floor(coordinate_m / kCell_m));
  }
  /// The range in cells_ of the cells (x, low_y) to (x, high_y).
  std::pair<std::uint32_t, std::uint32_t> row(std::int32_t x, std::int32_t low_y, std::int32_t high_y) const;

  const perception::SceneCluxels& all_;
  double origin_z_ = 0;                                          ///< [m, map]
  float rounding_m_ = 0;                                         ///< bound of the error of heights
  double margin_m_ = 0;                                          ///< half of the largest cluxel box in plan view
  float tallest_half_m_ = 0;                                     ///< half of the highest box
  std::vector<Cell> cells_;                                      ///< ordered by x, then y; the last one is a sentinel
  std::vector<std::pair<std::int32_t, std::uint32_t>> columns_;  ///< x, and the first of its cells; then a sentinel
  std::vector<Entry> entries_;                                   ///< by cell, then by height
  std::vector<std::uint32_t> first_primitive_;                   ///< of each cell, in primitives_
  std::vector<perception::PrimitiveIndex> primitives_;           ///< of each cell, each once
};

}  // namespace cluxel::rules
