// SPDX-License-Identifier: Apache-2.0
// How often rays hit a thing that is there is measured on the votes of all scans.
#include "tasks/changes/object_states.hpp"

#include <algorithm>

namespace cluxel::tasks {

using perception::PresenceState;

namespace {

bool leftOnALaterVisit(std::span<const perception::ScanVotes> votes, const perception::Visibility& thing,
                       const perception::PresenceParams& params) {
  if (!showPresence(votes, thing, params)) return false;
  // Goes to the end of the visit that saw it last: what later visits saw decides.
  double last_of_visit_s = presenceOf(votes, thing, params)->last_seen_s;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    if (votes[i].time_s <= last_of_visit_s) continue;
    if (votes[i].time_s - last_of_visit_s > kPauseOfVisits_s) return showAbsence(votes.subspan(i), thing, params);
    last_of_visit_s = votes[i].time_s;
  }
  return false;
}

}  // namespace

ObjectStates statesOf(std::uint32_t object, std::span<const perception::ScanVotes> votes, double since_s) {
  constexpr perception::PresenceParams kParams;
  const auto later = std::find_if(votes.begin(), votes.end(), [&](const auto& vote) { return vote.time_s >= since_s; });
  const auto before = votes.first(static_cast<std::size_t>(later - votes.begin())),
             after = votes.subspan(before.size());
  const perception::Visibility thing = perception::visibilityOf(votes);
  ObjectStates states;
  states.object = object;
  states.before = stateAfter(before, thing, kParams), states.after = stateAfter(after, thing, kParams);
  if (states.before == PresenceState::Present && states.after == PresenceState::Absent)
    states.was_away = leftOnALaterVisit(after, thing, kParams);
  if (states.before == PresenceState::Absent && states.after == PresenceState::Present)
    states.was_away = leftOnALaterVisit(before, thing, kParams);
  states.log_odds_before = logOddsOfPresence(before, thing.share_of_hits, kParams);
  states.log_odds_after = logOddsOfPresence(after, thing.share_of_hits, kParams);
  return states;
}

}  // namespace cluxel::tasks
