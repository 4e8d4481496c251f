// SPDX-License-Identifier: Apache-2.0
// Whether an object was there before and after a time.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "perception/visibility/presence.hpp"
#include "tasks/changes/visit_votes.hpp"

namespace cluxel::tasks {

struct ObjectStates {
  std::uint32_t object = 0;  ///< number in MapReader::objects()
  perception::PresenceState before = perception::PresenceState::NotObserved,
                            after = perception::PresenceState::NotObserved;
  double log_odds_before = 0, log_odds_after = 0;  ///< of "there", from the scans that tell the states
  double coverage_before = 0, coverage_after = 0;  ///< share of its places that these scans hit or saw through
  /// Surely present at the end of one time and absent at that of the other, though it was surely there on an earlier
  /// visit of that other time. Scans of one visit that see through a thin thing do not tell that it left.
  bool was_away = false;
  /// Surely present at the end of one time and absent at that of the other, which saw through nearly all and hit none.
  bool is_all_gone = false;
  std::vector<std::uint32_t> visits{};               ///< on which it was surely there, ascending
  Eigen::AlignedBox3d box{};                         ///< of its cluxels [m, map]
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< of its upright box [m, map]
};

/// Whether its states tell a change that its cluxels may not tell.
inline bool changedAsWhole(const ObjectStates& states) {
  return states.was_away || states.is_all_gone;
}

/// Whether it was there, and scans of the later time do not tell of it.
inline bool wasNotObservedAgain(const ObjectStates& states) {
  return states.before == perception::PresenceState::Present && states.after == perception::PresenceState::NotObserved;
}

/// The states that the votes of scans of the visits before and after tell. `votes` ascend by time. `hit_by_others`:
/// places that scans hit which are not compared, so that the share of places seen through is the same whatever is
/// compared. The box and the centre are not set.
ObjectStates statesOf(std::uint32_t object, std::span<const perception::ScanVotes> votes, const Visits& visits,
                      const perception::PlaceSet& hit_by_others = {});

}  // namespace cluxel::tasks
