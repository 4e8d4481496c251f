// SPDX-License-Identifier: Apache-2.0
// Intervals are subarrays of maximum sum (Kadane's method).
#include "perception/visibility/presence.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace cluxel::perception {

namespace {

double count(const PlaceSet& places) {
  return static_cast<double>(places.count());
}

/// Scans by number: from `begin` to before `end`.
struct Interval {
  std::size_t begin = 0, end = 0;
  double log_odds = 0;  ///< of "there"
};

/// The scans with the largest sum of log-odds; none when no sum is positive. Its first and its last scan hit the thing.
std::optional<Interval> likeliestOf(std::span<const ScanVotes> votes, const Visibility& thing,
                                    const PresenceParams& params) {
  Interval best, current;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    if (current.log_odds <= 0) current = {i, i, 0};
    current.log_odds += logOddsOfPresence(votes.subspan(i, 1), thing.share_of_hits, params);
    current.end = i + 1;
    if (current.log_odds > best.log_odds) best = current;
  }
  return best.end > best.begin ? std::optional(best) : std::nullopt;
}

/// From the first to the last time that the thing was there; `log_odds` of the likeliest of these times. It was there,
/// too, before or after the likeliest one, where scans in a row say so with `decided` or more.
std::optional<Interval> timesOf(std::span<const ScanVotes> votes, const Visibility& thing,
                                const PresenceParams& params) {
  std::optional<Interval> there = likeliestOf(votes, thing, params);
  if (!there) return there;
  while (const auto again = likeliestOf(votes.subspan(there->end), thing, params)) {
    if (again->log_odds < params.decided) break;
    there->end += again->end;
  }
  while (const auto earlier = likeliestOf(votes.first(there->begin), thing, params)) {
    if (earlier->log_odds < params.decided) break;
    there->begin = earlier->begin;
  }
  return there;
}

}  // namespace

void addVotes(std::vector<ScanVotes>& votes, const ScanVotes& scan) {
  if (votes.empty() || votes.back().time_s != scan.time_s) {
    votes.push_back(scan);
  } else {
    votes.back().hits |= scan.hits;
    votes.back().seen_through |= scan.seen_through;
  }
  votes.back().seen_through &= ~votes.back().hits;
}

double shareOfHits(std::span<const ScanVotes> votes) {
  double hits = 0, covered = 0;
  for (const ScanVotes& vote : votes)
    if (vote.hits.any()) hits += count(vote.hits), covered += count(vote.hits) + count(vote.seen_through);
  return shareOfHits(hits, covered);
}

double shareOfHits(double hits, double looks) {
  constexpr double kLeast = 0.3, kMost = 0.98;
  return looks == 0 ? kMost : std::clamp(hits / looks, kLeast, kMost);
}

Visibility visibilityOf(std::span<const ScanVotes> votes) {
  PlaceSet hit;
  for (const ScanVotes& vote : votes) hit |= vote.hits;
  return {shareOfHits(votes), hit};
}

double logOddsOfPresence(std::span<const ScanVotes> votes, double share_of_hits, const PresenceParams& params) {
  const double hit = std::log(share_of_hits / params.hit_when_gone);
  const double through = std::log((1 - share_of_hits) / (1 - params.hit_when_gone));
  double sum = 0;
  for (const ScanVotes& vote : votes) sum += hit * count(vote.hits) + through * count(vote.seen_through);
  return sum;
}

double logOddsOfPresence(double hits, double seen_through, double share_of_hits, const PresenceParams& params) {
  return hits * std::log(share_of_hits / params.hit_when_gone) +
         seen_through * std::log((1 - share_of_hits) / (1 - params.hit_when_gone));
}

bool showAbsence(std::span<const ScanVotes> votes, const Visibility& thing, const PresenceParams& params) {
  if (logOddsOfPresence(votes, thing.share_of_hits, params) > -params.decided) return false;
  PlaceSet hit, seen_through;
  for (const ScanVotes& vote : votes) hit |= vote.hits, seen_through |= vote.seen_through;
  const double seen_empty = count(seen_through & thing.places & ~hit);
  return seen_empty > 0 && seen_empty >= params.min_share * count(thing.places);
}

std::optional<Presence> presenceOf(std::span<const ScanVotes> votes, const Visibility& thing,
                                   const PresenceParams& params) {
  const std::optional<Interval> there = timesOf(votes, thing, params);
  if (!there) return std::nullopt;
  Presence presence{votes[there->begin].time_s, votes[there->end - 1].time_s, std::nullopt, std::nullopt};
  const auto sawThrough = [](const ScanVotes& vote) { return vote.seen_through.any(); };
  const auto before = votes.first(there->begin), after = votes.subspan(there->end);
  if (showAbsence(before, thing, params))
    presence.seen_empty_s = std::find_if(before.rbegin(), before.rend(), sawThrough)->time_s;
  if (showAbsence(after, thing, params))
    presence.seen_through_s = std::find_if(after.begin(), after.end(), sawThrough)->time_s;
  return presence;
}

bool showPresence(std::span<const ScanVotes> votes, const Visibility& thing, const PresenceParams& params) {
  const auto likeliest = likeliestOf(votes, thing, params);
  return likeliest && likeliest->log_odds >= params.decided;
}

std::string_view nameOf(PresenceState state) {
  constexpr std::array<std::string_view, 3> kNames{"present", "absent", "not observed"};
  return kNames[static_cast<std::size_t>(state)];
}

namespace {

/// The share of the places of a thing that scans hit or saw through.
double coverageOf(std::span<const ScanVotes> votes, const Visibility& thing) {
  PlaceSet told;
  for (const ScanVotes& vote : votes) told |= vote.hits | vote.seen_through;
  return thing.places.none() ? 0 : count(told & thing.places) / count(thing.places);
}

}  // namespace

StateAtEnd stateAtEnd(std::span<const ScanVotes> votes, std::span<const std::uint32_t> visits, const Visibility& thing,
                      const PresenceParams& params) {
  const auto told = [&](PresenceState state, std::span<const ScanVotes> some) {
    return StateAtEnd{state, logOddsOfPresence(some, thing.share_of_hits, params), coverageOf(some, thing)};
  };
  const auto there = timesOf(votes, thing, params);
  const auto present = [&] {
    const auto while_there = votes.subspan(there->begin, there->end - there->begin);
    return StateAtEnd{PresenceState::Present, there->log_odds, coverageOf(while_there, thing)};
  };
  if (there) {
    const auto end = std::upper_bound(visits.begin(), visits.end(), visits[there->end - 1]);
    const auto later = votes.subspan(static_cast<std::size_t>(end - visits.begin()));
    if (showAbsence(later, thing, params)) return told(PresenceState::Absent, later);
    if (there->log_odds >= params.decided) return present();
  }
  // Weak evidence for the thing does not outweigh what shows that it is gone.
  if (showAbsence(votes, thing, params)) return told(PresenceState::Absent, votes);
  // Nor does it tell a state when scans since then outweigh it, and too few places are seen through to show the
  // absence.
  const auto isOutweighed = [&] {
    return logOddsOfPresence(votes.subspan(there->begin), thing.share_of_hits, params) <= 0;
  };
  return there && !isOutweighed() ? present() : told(PresenceState::NotObserved, votes);
}

}  // namespace cluxel::perception
