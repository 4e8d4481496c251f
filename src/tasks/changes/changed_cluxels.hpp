// SPDX-License-Identifier: Apache-2.0
// Which cluxels vanished or appeared between two groups of scans, and the clusters that they form.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "perception/segments/scene.hpp"
#include "perception/visibility/scan_rays.hpp"
#include "tasks/changes/change_groups.hpp"
#include "tasks/changes/scan_numbers.hpp"
#include "tasks/changes/visit_votes.hpp"

namespace cluxel::tasks {

/// What the rays of a group of scans found at a cluxel.
struct RayFindings {
  ScanNumbers hits{};          ///< scans that hit the place
  ScanNumbers seen_through{};  ///< scans of which several rays saw through it
  /// Scans with so few rays near the place that they may have missed a thin thing: those that hit, those that passed.
  ScanNumbers sparse_hits{}, passed{};
  /// Rays near the place of the scans that passed it: those that did, and those that were stopped before.
  std::uint64_t passing_rays = 0, stopped_rays = 0;
  std::size_t aside = 0;  ///< scans that passed it with rays of which none would have ended at the thing

  bool isHit() const { return !hits.empty(); }
  /// Rays passed the place, and none ended there.
  bool isEmpty() const { return hits.empty() && !(seen_through.empty() && passed.empty()); }

  ScanNumbers allPassed() const {
    ScanNumbers scans = seen_through;
    scans |= passed;
    return scans;
  }

  /// Adds what the rays of one scan found.
  void add(const perception::PlaceVerdict& found, std::uint32_t scan);
};

enum class CluxelChange : std::uint8_t {
  Undecided,  ///< not covered before or after
  Stable,     ///< hit before and after
  Vanished,   ///< hit before and empty after
  Appeared,   ///< empty before and hit after
};
/// What changed at a cluxel of which rays tell at both times.
CluxelChange changeOf(const RayFindings& before, const RayFindings& after);

/// Cluxels that changed, and all that intersect one of them.
struct ChangedCluxels {
  perception::SceneCluxels cluxels;       ///< with the edges of those that changed; no labels, seeds and primitives
  std::vector<std::uint32_t> number;      ///< of each in the scene of the map, ascending
  std::vector<std::uint32_t> object;      ///< of each in MapReader::objects(), or kNoObject
  std::vector<bool> is_told;              ///< rays are compared with it: false for ground
  std::vector<perception::Place> places;  ///< on the thing that it belongs to; of those that rays are compared with
  std::vector<CluxelChange> changes;
  std::vector<RayFindings> before, after;
  Visits visits{};  ///< of the scans
};

/// Of the rays near the places of what is gone, so many may end before them for each that passes.
inline constexpr double kMostStopped = 0.75;

/// Connected clusters of five or more cluxels that changed alike, each ascending, in the order of their first cluxel.
/// Cluxels that rays of a visit passed after the last visit that hit them do not count: they belong to a thing that had
/// left by the end of its time, beside which another may stand. A cluster is dropped when the rays may have missed a
/// thing that is still there. Of the scans while it was there, those do not count that hit nothing in and around it and
/// saw through five of its cluxels, nor those of visits that saw it away (visitsWithoutIt): it was away for a while.
/// - Each scan that passed a cluxel adds log((1 - p) / 0.95), where p is the share of hits in and around the cluster
///   while the thing was there: on average of its cluxels the sum must be -3.5 or less, so that a crown needs more
///   scans than a car.
/// - A cluster is gone as a whole when 90 % of the decided cluxels in and around it changed like it. Then either five
///   of its cluxels were seen through by several rays of one scan, or scans agree: each that passed it adds
///   log((1 - p) / 0.95) for each cluxel that it passed, where p is the share of hits among scans with few rays in and
///   around the cluster while the thing was there, but -2 at least, because where the pose of a scan is off, its rays
///   miss all of a thing together. The sum must be -6 or less, so that three scans are needed; -4, thus two scans,
///   for 12 cluxels or more that 60 % of the scans with few rays hit while the thing was there.
/// - A part of something that stays needs scans that agree, and one of two: several rays of one scan saw through five
///   of its cluxels where 75 % changed like it, or ten where 50 % did; or it has eight cluxels or more, and of the
///   decided ones in and around it that lie at the height of its middle or higher, 90 % changed like it. Then all is
///   gone from there upwards, as of a hedge that was cut. What scans with poor poses miss is mostly an edge of
///   something that stays, and a gap in a crown has leaves beside it.
/// And of the rays near its cluxels at most three ended before them for each four that passed, and at least a
/// quarter of its cluxels must each be passed by a ray that would have ended at the thing (PlaceVerdict::is_aside).
std::vector<ChangeGroup> clustersOf(CluxelChange kind, const ChangedCluxels& all);
/// Those of the possible clusters that clustersOf() keeps. `all` need not hold more than these and what intersects
/// them.
std::vector<ChangeGroup> clustersAmong(std::vector<ChangeGroup> possible, CluxelChange kind, const ChangedCluxels& all);

/// Clusters that are kept if rays hit the thing often enough while it was there. Only what rays found without it is
/// read.
std::vector<ChangeGroup> possibleClusters(CluxelChange kind, const ChangedCluxels& all);

}  // namespace cluxel::tasks
