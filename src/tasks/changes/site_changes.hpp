// SPDX-License-Identifier: Apache-2.0
// What changed at a place between two times: what vanished, appeared or moved, and what was not observed again.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "tasks/changes/change_survey.hpp"
#include "tasks/changes/changed_things.hpp"

namespace cluxel::tasks {

/// Scans taken without a pause of half an hour.
struct Visit {
  double begin_s = 0, end_s = 0;  ///< times of its first and last scan
  std::size_t scans = 0;
};

/// The visits of the clouds with a time and a pose, in the order of time.
std::vector<Visit> visitsOf(const std::vector<mapping::Cloud>& clouds);

struct SiteChange {
  enum class Kind { Vanished, Appeared, Moved };
  Kind kind = Kind::Vanished;
  ChangedThing thing;               ///< what vanished or appeared; for Moved, what was there before
  std::optional<ChangedThing> now;  ///< for Moved: what is there now
  double distance_m = 0;            ///< of Moved
};
std::string_view nameOf(SiteChange::Kind kind);  ///< "vanished"

/// The times that are asked about [s since 1970].
struct ChangeTimes {
  std::optional<double> since_s{};  ///< scans from then on are "after"; absent: the begin of the last visit
  std::optional<double> until_s{};  ///< later scans do not count
};

struct SiteChanges {
  ComparedTimes times;
  std::vector<ObjectStates> states;  ///< of each object but ground, by number
  std::vector<SiteChange> changes;   ///< by first cluxel
};

/// Compares how things were at the end of the scans before `since_s` with how they are at the end of those from it on.
/// What vanished are clusters of cluxels that rays hit before and see through afterwards; what appeared, the other way
/// round. What had left before `since_s` has not vanished since, and what came and left again has not appeared. When an
/// object vanished, and another of its class and nearly its size appeared within 10 m, it has moved, unless one visit
/// saw both; nearest pairs first. Throws Error (InvalidArgument) when one side has no scan with time and pose. Cost and
/// memory as for surveyOf().
SiteChanges changesIn(const mapping::MapReader& map, const ChangeTimes& times, unsigned threads,
                      std::size_t max_cluxels = kRegionCluxels);

/// What each visit but the first changed: how things were at the end of the four visits before it, and how that visit
/// saw them. Cost: that of changesIn() for five visits, for each visit.
std::vector<SiteChanges> changesOfVisits(const mapping::MapReader& map, unsigned threads);

/// "since 2023-11-15T22:13:20.000000Z: 3 changes; 20 objects are there, ...": one line without an end.
std::string summaryOf(const SiteChanges& changes);

/// "StreetSign object/0123456789ab", or "part of ...", or "something unnamed".
std::string nameOf(const mapping::MapReader& map, const ChangedThing& thing);

/// A part of an object that changed while the object as a whole did not: one bicycle of two that stood together.
struct PartStates {
  const ChangedThing* part = nullptr;  ///< of SiteChanges::changes; its object is known
  perception::PresenceState before = perception::PresenceState::NotObserved,
                            after = perception::PresenceState::NotObserved;
};
/// What vanished of objects whose state afterwards is another than absent, and what appeared of objects whose state
/// before is another, in the order of the changes. `changes` must outlive the result.
std::vector<PartStates> statesOfParts(const SiteChanges& changes);

/// Seconds since 1970 of "2023-11-15T22:13:20Z", "2023-11-15" or a number of seconds. Throws Error (InvalidArgument).
double timeNamed(const std::string& text);

/// Numbers of objects that came or went by their states, though no change names them or lies around their middle:
/// states follow from all places of an object together, a change from places that are each seen well.
std::vector<std::uint32_t> objectsThatDifferByStates(const SiteChanges& changes);

std::string changesJson(const mapping::MapReader& map, const SiteChanges& changes);

}  // namespace cluxel::tasks
