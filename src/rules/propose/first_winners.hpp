// SPDX-License-Identifier: Apache-2.0
// The objects that won the first round of a stratum in which evidence looks at the classes of its rivals.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "rules/propose/candidate.hpp"

namespace cluxel::rules {

struct ReasoningState;

class FirstWinners {
 public:
  /// The objects from number `first` on, with the fragments that they own or share.
  FirstWinners(const ReasoningState& after, std::size_t first);

  /// The smallest gap between a cluxel of the candidate and one of a winner of these classes, in plan view when
  /// `in_plan`; a winner that has cluxels of the candidate does not count. Absent when it is larger than `limit_m`.
  /// `classes`: by place in RuleSet::order. Cost: the product of the cluxels of those whose boxes are near.
  std::optional<double> nearestGap(const ReasoningState& state, const Candidate& candidate,
                                   const std::vector<bool>& classes, bool in_plan, double limit_m) const;

 private:
  struct Winner {
    std::size_t class_number = 0;
    Eigen::AlignedBox3d box;
    std::vector<std::uint32_t> cluxels;  ///< ascending
  };
  std::vector<Winner> winners_;
};

}  // namespace cluxel::rules
