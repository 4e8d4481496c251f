// SPDX-License-Identifier: Apache-2.0
// How many hops primitives are away from a change.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "perception/segments/scene.hpp"

namespace cluxel::rules {

/// The last layer that a seam needs (decision 0092).
inline constexpr std::uint32_t kLastLayer = 3;
/// The layer of primitives that are farther away, or that no chain of hops leads to.
inline constexpr std::uint32_t kNoLayer = std::numeric_limits<std::uint32_t>::max();

class Layering;

/// Layer 0 are the dirty primitives and those within reach of a box in `gone`, without those that are fixed; layer n +
/// 1, up to kLastLayer, are the primitives within reach of layer n that are in none before. Fixed primitives that are
/// not dirty are in no layer. Reach is measured in plan view between boxes of cluxels and rounded up to coarse cells;
/// edges and relations lead to the next layer too.
class LayerSearch {
 public:
  /// `scene` and `is_fixed` (by primitive) must outlive it. Cost: linear in the cluxels.
  LayerSearch(const perception::Scene& scene, const std::vector<char>& is_fixed, double reach_m);
  ~LayerSearch();
  LayerSearch(LayerSearch&&) noexcept;
  LayerSearch& operator=(LayerSearch&&) = delete;

  /// By primitive. Cost: some hundred steps for each cell of 2 m that the layers cover.
  std::vector<std::uint32_t> around(const std::vector<char>& is_dirty, std::span<const Eigen::AlignedBox2d> gone);

 private:
  std::unique_ptr<Layering> layering_;
};

/// One search.
std::vector<std::uint32_t> layersAround(const perception::Scene& scene, const std::vector<char>& is_dirty,
                                        const std::vector<char>& is_fixed, std::span<const Eigen::AlignedBox2d> gone,
                                        double reach_m);

}  // namespace cluxel::rules
