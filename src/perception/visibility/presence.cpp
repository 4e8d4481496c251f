// SPDX-License-Identifier: Apache-2.0
// The interval is the subarray of maximum sum (Kadane's method).
#include "perception/visibility/presence.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace cluxel::perception {

namespace {

double count(const PlaceSet& places) {
  return static_cast<double>(places.count());
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
  return covered == 0 ? 0.98 : std::clamp(hits / covered, 0.3, 0.98);
}

Visibility visibilityOf(std::span<const ScanVotes> votes) {
  PlaceSet hit;
  for (const ScanVotes& vote : votes) hit |= vote.hits;
  return {shareOfHits(votes), hit.count()};
}

double logOddsOfPresence(std::span<const ScanVotes> votes, double share_of_hits, const PresenceParams& params) {
  const double hit = std::log(share_of_hits / params.hit_when_gone);
  const double through = std::log((1 - share_of_hits) / (1 - params.hit_when_gone));
  double sum = 0;
  for (const ScanVotes& vote : votes) sum += hit * count(vote.hits) + through * count(vote.seen_through);
  return sum;
}

bool showAbsence(std::span<const ScanVotes> votes, const Visibility& thing, const PresenceParams& params) {
  if (logOddsOfPresence(votes, thing.share_of_hits, params) > -params.decided) return false;
  PlaceSet hit, seen_through;
  for (const ScanVotes& vote : votes) hit |= vote.hits, seen_through |= vote.seen_through;
  return count(seen_through & ~hit) >= params.min_share * static_cast<double>(thing.places);
}

std::optional<Presence> presenceOf(std::span<const ScanVotes> votes, const Visibility& thing,
                                   const PresenceParams& params) {
  std::size_t best_begin = 0, best_end = 0, begin = 0;
  double best = 0, sum = 0;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    if (sum <= 0) sum = 0, begin = i;
    sum += logOddsOfPresence(votes.subspan(i, 1), thing.share_of_hits, params);
    if (sum > best) best = sum, best_begin = begin, best_end = i + 1;
  }
  if (best_begin == best_end) return std::nullopt;
  // The sum is largest where the interval ends with scans that hit the thing.
  Presence presence{votes[best_begin].time_s, votes[best_end - 1].time_s, std::nullopt, std::nullopt};
  const auto sawThrough = [](const ScanVotes& vote) { return vote.seen_through.any(); };
  const auto before = votes.first(best_begin), after = votes.subspan(best_end);
  if (showAbsence(before, thing, params))
    presence.seen_empty_s = std::find_if(before.rbegin(), before.rend(), sawThrough)->time_s;
  if (showAbsence(after, thing, params))
    presence.seen_through_s = std::find_if(after.begin(), after.end(), sawThrough)->time_s;
  return presence;
}

std::string_view nameOf(PresenceState state) {
  constexpr std::array<std::string_view, 3> kNames{"present", "absent", "not observed"};
  return kNames[static_cast<std::size_t>(state)];
}

PresenceState stateAfter(std::span<const ScanVotes> votes, const Visibility& thing, const PresenceParams& params) {
  if (const auto presence = presenceOf(votes, thing, params))
    return presence->seen_through_s ? PresenceState::Absent : PresenceState::Present;
  return showAbsence(votes, thing, params) ? PresenceState::Absent : PresenceState::NotObserved;
}

}  // namespace cluxel::perception
