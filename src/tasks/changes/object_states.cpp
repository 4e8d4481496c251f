// SPDX-License-Identifier: Apache-2.0
// How often rays hit a thing that is there is measured on the votes of all scans that are compared.
#include "tasks/changes/object_states.hpp"

#include <algorithm>

namespace cluxel::tasks {

using perception::PresenceState;

namespace {

bool leftOnALaterVisit(std::span<const perception::ScanVotes> votes, const Visits& visits,
                       const perception::Visibility& thing, const perception::PresenceParams& params) {
  if (!showPresence(votes, thing, params)) return false;
  const std::uint32_t last_with_it = visits.at(presenceOf(votes, thing, params)->last_seen_s);
  const auto later =
      std::find_if(votes.begin(), votes.end(), [&](const auto& vote) { return visits.at(vote.time_s) > last_with_it; });
  return later != votes.end() && showAbsence({later, votes.end()}, thing, params);
}

/// Whether scans saw through nearly all places of a thing, and hit none.
bool sawThroughAll(std::span<const perception::ScanVotes> votes, const perception::Visibility& thing) {
  constexpr double kNearlyAll = 0.9;
  perception::PlaceSet hit, seen_through;
  for (const perception::ScanVotes& vote : votes) hit |= vote.hits, seen_through |= vote.seen_through;
  return hit.none() && static_cast<double>((seen_through & thing.places).count()) >=
                           kNearlyAll * static_cast<double>(thing.places.count());
}

}  // namespace

ObjectStates statesOf(std::uint32_t object, std::span<const perception::ScanVotes> votes, const Visits& visits,
                      const perception::PlaceSet& hit_by_others) {
  constexpr perception::PresenceParams kParams;
  std::vector<std::uint32_t> of_votes;
  for (const perception::ScanVotes& vote : votes) of_votes.push_back(visits.at(vote.time_s));
  const auto later = std::find_if(of_votes.begin(), of_votes.end(), [&](auto visit) { return visits.isAfter(visit); });
  const auto scans_before = static_cast<std::size_t>(later - of_votes.begin());
  const auto before = votes.first(scans_before), after = votes.subspan(scans_before);
  perception::Visibility thing = perception::visibilityOf(votes);
  thing.places |= hit_by_others;
  ObjectStates states;
  states.object = object;
  const std::span all_visits(of_votes);
  const perception::StateAtEnd at_end_before = stateAtEnd(before, all_visits.first(scans_before), thing, kParams),
                               at_end_after = stateAtEnd(after, all_visits.subspan(scans_before), thing, kParams);
  states.before = at_end_before.state, states.log_odds_before = at_end_before.log_odds;
  states.coverage_before = at_end_before.coverage, states.coverage_after = at_end_after.coverage;
  states.after = at_end_after.state, states.log_odds_after = at_end_after.log_odds;
  const bool left = states.before == PresenceState::Present && states.after == PresenceState::Absent;
  const bool came = states.before == PresenceState::Absent && states.after == PresenceState::Present;
  if (left || came) {
    const auto without_it = left ? after : before, with_it = left ? before : after;
    // A few hits call a thing present, but do not show that it came or was there.
    const bool was_surely_there = showPresence(with_it, thing, kParams);
    states.was_away = was_surely_there && leftOnALaterVisit(without_it, visits, thing, kParams);
    states.is_all_gone = was_surely_there && sawThroughAll(without_it, thing);
  }
  states.visits = visitsWithIt(votesByVisit(votes, visits));
  return states;
}

}  // namespace cluxel::tasks
