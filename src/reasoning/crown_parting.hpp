// SPDX-License-Identifier: Apache-2.0
// Parts crowns that touch among their trunks: every cluxel goes to the trunk from which the way through the crown is
// shortest. Straight lines would give a branch that reaches over to the neighbour's side to the neighbour.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "cluxel/perception/scene.hpp"

namespace cluxel {

struct CrownSource {
  std::vector<std::uint32_t> trunk;  ///< cluxels, ascending
  double reach_m = 8, jump_m = 0.5, start_m = 0.5, clearance_m = 0;
  std::function<bool(std::uint32_t)> may_take;  ///< whether this source claims a cluxel
};

inline constexpr std::uint32_t kNoSource = 0xFFFFFFFFU;

/// For each of `crown` (ascending) the number of its source, or kNoSource. Ways follow the cluxel graph with metric
/// lengths; gaps up to jump_m (from the trunk: start_m) are bridged at double length; no way leaves the reach around
/// the trunk's top in plan view. Equal ways go to the source that comes first. Cost O(n log n) for the crown's edges.
std::vector<std::uint32_t> partCrown(const SceneCluxels& all, std::span<const std::uint32_t> crown,
                                     std::span<const CrownSource> sources);

/// Plan position of a trunk's top: the mean of its highest half metre [m, map].
Eigen::Vector2d topOf(const SceneCluxels& all, std::span<const std::uint32_t> trunk);

}  // namespace cluxel
