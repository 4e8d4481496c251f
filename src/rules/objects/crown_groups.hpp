// SPDX-License-Identifier: Apache-2.0
// Parts of a crown that can be split apart from each other.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "rules/objects/crown_splitting.hpp"

namespace cluxel::rules {

/// The sources of a crown that is split.
struct CrownParts {
  const perception::SceneCluxels& all;
  std::span<const CrownSource> sources;
  std::vector<Eigen::Vector2d> tops;  ///< of the sources' trunks

  bool isBeyond(const Eigen::Vector3d& centre, std::uint32_t source) const {
    return (centre.head<2>() - tops[source]).norm() > sources[source].reach_m;
  }
  /// Whether the cluxel is high enough, within reach and claimed.
  bool mayTake(std::uint32_t source, std::uint32_t cluxel) const {
    const CrownSource& taker = sources[source];
    return static_cast<double>(all.height_above_ground[cluxel]) >= taker.clearance_m &&
           !isBeyond(all.center[cluxel], source) && (!taker.may_take || taker.may_take(cluxel));
  }
};

/// Sources that may take a common cluxel, and the cluxels that one of them may take.
struct SourceGroup {
  std::vector<std::uint32_t> sources, cluxels;
  std::vector<std::uint32_t> positions;  ///< of the cluxels in the crown
  /// For each of the cluxels the sources that may take it, by their places in `sources`, and then kNoSource.
  std::vector<std::uint32_t> takers;
};

/// Where a cluxel is searched: the group of sources, and its number there.
struct SearchPlace {
  std::uint32_t group = kNoSource, at = 0;
};

/// Groups of which no two may take a common cluxel. Cost: linear in the crown and in the sources around its cluxels.
std::vector<SourceGroup> groupsOf(const CrownParts& parts, std::span<const std::uint32_t> crown);

}  // namespace cluxel::rules
