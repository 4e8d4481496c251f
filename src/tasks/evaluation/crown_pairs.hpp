// SPDX-License-Identifier: Apache-2.0
// Whether the map separates trees whose crowns touch.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "tasks/evaluation/touching_trees.hpp"

namespace cluxel::tasks {

struct CrownPairScore {
  std::uint64_t pairs = 0;   ///< true trees that touch and whose trunks stand 2 m or more apart
  std::uint64_t parted = 0;  ///< of these, the pairs that have most of their points in two different objects
};

class CrownPairs {
 public:
  /// A point of the true tree `instance`; `is_trunk` when its true primitive is a column. `object` kNoObjectOfPoint
  /// means none.
  void add(const Eigen::Vector3d& p_map, std::int32_t instance, bool is_trunk, std::uint32_t object);
  /// Trees without points of a trunk, and those of `ambiguous` (sorted), count in no pair. Is called once, after all
  /// points.
  CrownPairScore score(const std::vector<std::int32_t>& ambiguous);

 private:
  struct TrueTree {
    Eigen::Vector2d trunk_sum = Eigen::Vector2d::Zero();
    std::uint64_t trunk_points = 0;
    std::map<std::uint32_t, std::uint64_t> objects;
  };
  static std::uint32_t mainObject(const TrueTree& tree);

  std::map<std::int32_t, TrueTree> trees_;
  std::unique_ptr<TouchingTrees> touching_ = std::make_unique<TouchingTrees>();
};

}  // namespace cluxel::tasks
