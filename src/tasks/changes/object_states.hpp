// SPDX-License-Identifier: Apache-2.0
// Whether an object was there before and after a time.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>

#include "perception/visibility/presence.hpp"

namespace cluxel::tasks {

/// Scans with a longer pause between them belong to different visits.
inline constexpr double kPauseOfVisits_s = 1800;

struct ObjectStates {
  std::uint32_t object = 0;  ///< number in MapReader::objects()
  perception::PresenceState before = perception::PresenceState::NotObserved,
                            after = perception::PresenceState::NotObserved;
  double log_odds_before = 0, log_odds_after = 0;  ///< of "there"
  /// Present at the end of one time and absent at that of the other, though it was surely there on an earlier visit of
  /// that other time. Scans of one visit that see through a thin thing do not tell that it left.
  bool was_away = false;
  Eigen::AlignedBox3d box{};                         ///< of its cluxels [m, map]
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< of its upright box [m, map]
};

/// The states that the votes of scans before `since_s` and from it on tell. `votes` ascend by time.
ObjectStates statesOf(std::uint32_t object, std::span<const perception::ScanVotes> votes, double since_s);

}  // namespace cluxel::tasks
