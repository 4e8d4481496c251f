// SPDX-License-Identifier: Apache-2.0
// Splits touching crowns among their trunks: a cluxel goes to the trunk with the shortest path through the crown.
// Straight-line distance would assign a branch that reaches across to the wrong tree.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "perception/segments/scene.hpp"

namespace cluxel::rules {

struct CrownSource {
  std::vector<std::uint32_t> trunk;  ///< cluxels, ascending
  double reach_m = 8, jump_m = 0.5, start_m = 0.5, clearance_m = 0;
  std::function<bool(std::uint32_t)> may_take;  ///< whether this source claims a cluxel
};

inline constexpr std::uint32_t kNoSource = 0xFFFFFFFFU;

class KnownSplits;

/// For each cluxel of `crown` (ascending), the number of its source, or kNoSource. Paths follow the cluxel graph with
/// metric edge lengths. Gaps up to jump_m (from the trunk: start_m) are bridged at twice their length. No path goes
/// beyond reach_m around the trunk's top in plan view. Ties go to the source with the smaller number, whatever the
/// number of threads. Cost O(n log n) in the crown's edges. Parts of the crown of which the outcome is `known` are not
/// searched; it may be null, and does not change the result.
std::vector<std::uint32_t> splitCrown(const perception::SceneCluxels& all, std::span<const std::uint32_t> crown,
                                      std::span<const CrownSource> sources, unsigned threads = 1,
                                      KnownSplits* known = nullptr);

/// Position of a trunk's top in plan view: the mean of its highest half metre [m, map].
Eigen::Vector2d topOf(const perception::SceneCluxels& all, std::span<const std::uint32_t> trunk);

}  // namespace cluxel::rules
