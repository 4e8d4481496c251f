// SPDX-License-Identifier: Apache-2.0
// What vanished, appeared and moved at a place between visits, and which objects were there before and after.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cluxel/object.hpp"

namespace cluxel {

/// Seconds since 1970-01-01 UTC, or a text: "2023-11-15T22:13:20Z", "2023-11-15", or such seconds.
using Time = std::variant<double, std::string>;

struct VisitOptions {
  /// Scans from then on count as "after". Absent: the begin of the last visit; a pause of half an hour ends a visit.
  std::optional<Time> since = {};
  std::optional<Time> until = {};  ///< later scans do not count; absent: all count
  bool with_points = false;        ///< gather SiteChanges::points, too
  unsigned threads = 0;            ///< 0: one per processor; the answer does not depend on it
};

/// What rays tell of a thing at the end of a time.
enum class PresenceState : std::uint8_t { Present, Absent, NotObserved };

/// What vanished or appeared together.
struct ChangedThing {
  std::string object;            ///< IRI of the object that most of it belongs to; empty when most belongs to none
  std::string class_name;        ///< of that object: "Car"; by IRI if that name is another's
  bool is_part = false;          ///< it is a part of that object
  std::size_t cluxel_count = 0;  ///< cluxels that it is made of, or is a part of
  Position min, max;             ///< corners of its box along the axes of the map frame
};

enum class SiteChangeKind : std::uint8_t { Vanished, Appeared, Moved };

struct SiteChange {
  SiteChangeKind kind = SiteChangeKind::Vanished;
  ChangedThing thing;               ///< of Moved: as it was before
  std::optional<ChangedThing> now;  ///< of Moved: what is there now
  double distance_m = 0;            ///< of Moved: between the middles of both boxes
};

/// Whether an object, all but ground, was there before and is there after.
struct ObjectStates {
  std::string iri;
  std::size_t number = 0;  ///< as Object::number
  std::string class_name;  ///< as ChangedThing's
  PresenceState before = PresenceState::NotObserved, after = PresenceState::NotObserved;
  double log_odds_before = 0, log_odds_after = 0;  ///< of "there"
  double coverage_before = 0, coverage_after = 0;  ///< share of its places that scans hit or saw through
  Position min, max;                               ///< corners of its box along the axes of the map frame
};

/// A part of an object that changed while the object as a whole did not.
struct PartStates {
  ChangedThing part;
  PresenceState before = PresenceState::NotObserved, after = PresenceState::NotObserved;
};

/// The measured points of what vanished and appeared while it was there, as a structure of arrays of one length, by
/// cloud and number.
struct ChangedPoints {
  std::vector<std::string> cloud_ids;  ///< of the clouds below, in their order
  std::vector<std::uint32_t> cloud;    ///< number in `cloud_ids`
  std::vector<std::uint32_t> point;    ///< number in Map::points(cloud)
  std::vector<std::uint32_t> change;   ///< number in SiteChanges::changes
  std::vector<std::uint8_t> is_gone;   ///< 1: measured before the thing vanished; 0: after it appeared

  std::size_t size() const { return point.size(); }
};

struct SiteChanges {
  double since_s = 0;             ///< the time that parts before and after [s since 1970]
  std::optional<double> until_s;  ///< absent: all scans from then on count
  std::string summary;            ///< one English line: how many changes, and how many objects are there
  std::vector<SiteChange> changes;
  std::vector<ObjectStates> states;  ///< by number
  std::vector<PartStates> parts;     ///< in the order of the changes
  ChangedPoints points;              ///< empty without VisitOptions::with_points
};

}  // namespace cluxel
