// SPDX-License-Identifier: Apache-2.0
// When a thing was there: the intervals of scans that speak for it, from votes of rays that hit it or saw through it.
#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace cluxel::perception {

/// Places on a thing: at most so many are compared with rays.
inline constexpr std::size_t kMaxPlaces = 256;
using PlaceSet = std::bitset<kMaxPlaces>;

/// What the scans of one time say about a thing: the places where rays ended, and those that they saw through.
struct ScanVotes {
  double time_s = 0;
  PlaceSet hits, seen_through;  ///< no place is in both
};

/// Adds what a scan says to votes sorted by time. Scans of one time speak together: a place that one of them hit is
/// hit.
void addVotes(std::vector<ScanVotes>& votes, const ScanVotes& scan);

struct PresenceParams {
  /// Chance that a ray ends at a place of a thing that is gone, because something else stands there now.
  double hit_when_gone = 0.05;
  /// A thing is gone, or not yet there, when the log-odds of "there" are at most the negative of this ...
  double decided = 6;
  /// ... and this share of the places that were ever hit is seen through and not hit.
  double min_share = 0.2;
};

/// From when to when a thing was there, as far as rays tell. It may have been away in between.
struct Presence {
  double first_seen_s = 0, last_seen_s = 0;  ///< scans that hit it
  std::optional<double> seen_empty_s;        ///< the last scan before that saw through it, when it was not yet there
  std::optional<double> seen_through_s;      ///< the first scan after that saw through it, when it is gone
};

/// The share of hits among the votes of scans that hit the thing at all, within [0.3, 0.98]: near 1 for a car, lower
/// for a crown that lets rays through.
double shareOfHits(std::span<const ScanVotes> votes);

/// The same of numbers of hits and of looks, both alike in unit; the upper limit when there was no look.
double shareOfHits(double hits, double looks);

/// Log-odds of "there": a hit counts log(p / h), a place seen through log((1 - p) / (1 - h)), with p the share of hits
/// and h `hit_when_gone`.
double logOddsOfPresence(std::span<const ScanVotes> votes, double share_of_hits, const PresenceParams& params);
/// The same of numbers of hits, and of places seen through.
double logOddsOfPresence(double hits, double seen_through, double share_of_hits, const PresenceParams& params);

/// What is known of a thing from all scans.
struct Visibility {
  double share_of_hits = 0;  ///< shareOfHits()
  PlaceSet places;           ///< that some scan hit
};
Visibility visibilityOf(std::span<const ScanVotes> votes);

/// Whether some scans show that the thing was not there. When no scan hit the thing, nothing shows it.
bool showAbsence(std::span<const ScanVotes> votes, const Visibility& thing, const PresenceParams& params);

/// The thing was there in the interval with the largest sum of log-odds, and in each earlier or later interval whose
/// sum is `decided` or more: what drove off and came back is there. Before the first of them or after the last the
/// thing was not there when showAbsence() holds of those scans. `votes` are sorted by time, one element a time. Absent
/// when no scan speaks for it.
std::optional<Presence> presenceOf(std::span<const ScanVotes> votes, const Visibility& thing,
                                   const PresenceParams& params);

/// Whether scans in a row show that the thing was there: their log-odds are `decided` or more.
bool showPresence(std::span<const ScanVotes> votes, const Visibility& thing, const PresenceParams& params);

enum class PresenceState : std::uint8_t { Present, Absent, NotObserved };
std::string_view nameOf(PresenceState state);  ///< "not observed"

struct StateAtEnd {
  PresenceState state = PresenceState::NotObserved;
  double log_odds = 0;  ///< of "there", from the scans that tell the state; from all when they do not tell it
  /// The share of its places that these scans hit or saw through, in [0, 1]. Of a thing that is there, the scans from
  /// the first to the last time that it was there count.
  double coverage = 0;
};

/// The state of a thing at the end of some scans: absent when its place was seen through after the visit that ends the
/// last interval in which it was there, or where evidence for that interval is weak (showPresence) and all of the scans
/// show that it is away. `visits`: of each of the scans, ascending. Within one visit nothing leaves.
StateAtEnd stateAtEnd(std::span<const ScanVotes> votes, std::span<const std::uint32_t> visits, const Visibility& thing,
                      const PresenceParams& params);

}  // namespace cluxel::perception
