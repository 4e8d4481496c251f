// SPDX-License-Identifier: Apache-2.0
// What visits tell of a thing: on which it was there, and whether it was away at the end of some of them.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "perception/visibility/presence.hpp"
#include "tasks/changes/scan_numbers.hpp"

namespace cluxel::tasks {

/// Scans with such a pause between them, or a longer one, belong to different visits.
inline constexpr double kPauseOfVisits_s = 1800;

/// The visits of scans with a time and a pose. A visit ends where the times that are compared meet.
class Visits {
 public:
  Visits() = default;
  /// `times_s`: of the scans, ascending. `since_s`: scans from then on are of later visits.
  Visits(std::span<const double> times_s, double since_s);
  /// 0 where no times were given.
  std::uint32_t ofScan(std::uint32_t scan) const { return of_scan_.empty() ? 0 : of_scan_[scan]; }
  std::uint32_t at(double time_s) const;  ///< of a scan with this time
  bool isAfter(std::uint32_t visit) const { return begins_s_[visit] >= since_s_; }

 private:
  double since_s_ = 0;
  std::vector<double> begins_s_;
  std::vector<std::uint32_t> of_scan_;
};

/// How often scans hit places of a thing, and how often they passed one.
struct LookCounts {
  std::size_t hits = 0, passed = 0;
};

/// One vote a visit; scans of one visit speak together, and a place that one of them hit is hit.
struct VisitVotes {
  std::vector<std::uint32_t> visits;         ///< ascending
  std::vector<perception::ScanVotes> votes;  ///< of each of them; without a time
  std::vector<LookCounts> looks;             ///< of the scans of each of them, which speak one by one here
};

/// Gathers what scans found at the places of a thing.
class PlaceVotes {
 public:
  PlaceVotes(const Visits& visits, std::size_t places) : visits_(visits), places_(places) {}
  /// Places are added in their order.
  void addPlace(const ScanNumbers& hits, const ScanNumbers& passed);
  VisitVotes take();

 private:
  const Visits& visits_;
  std::size_t places_, added_ = 0;
  std::map<std::uint32_t, perception::ScanVotes> of_visit_;
  std::map<std::uint32_t, LookCounts> looks_;
};

/// Merges votes of scans, which ascend by time.
VisitVotes votesByVisit(std::span<const perception::ScanVotes> votes, const Visits& visits);

/// Those of some visits, which ascend.
VisitVotes votesOn(std::span<const std::uint32_t> visits, const VisitVotes& votes);

/// The visits on which the thing was surely there, ascending.
std::vector<std::uint32_t> visitsWithIt(const VisitVotes& votes);

/// The visits that surely saw it away, where it was surely there on another, ascending. How often rays hit it follows
/// from the visit that speaks most for it: on others something else may have stood in some of its places.
std::vector<std::uint32_t> visitsWithoutIt(const VisitVotes& votes);

/// Whether the last of the visits show that the thing had left after it was there.
bool isAwayAtEnd(const VisitVotes& votes);

/// What the visits of two times found at the places of a thing, in one list.
VisitVotes joined(const VisitVotes& before, const VisitVotes& after);

/// How often the thing came or went from one visit that tells of it for certain to the next one. The looks of its scans
/// tell, because some rays end in places that are mostly passed: a pole runs through the place of a head. How often
/// rays hit the thing follows as for visitsWithoutIt().
std::size_t comingsAndGoings(const VisitVotes& votes);

bool haveCommon(std::span<const std::uint32_t> ascending, std::span<const std::uint32_t> others);

}  // namespace cluxel::tasks
