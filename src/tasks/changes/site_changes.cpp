// SPDX-License-Identifier: Apache-2.0
// Moves are pairs of things that vanished and appeared.
#include "tasks/changes/site_changes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "mapping/facts/map_facts.hpp"
#include "rdf/map_iris.hpp"
#include "sparql/values/calendar.hpp"
#include "tasks/finite_number.hpp"
#include "tasks/ways/way_report.hpp"

namespace cluxel::tasks {

namespace {

using perception::PresenceState;
using ChangeJson = nlohmann::ordered_json;

constexpr double kMaxMove_m = 10;
constexpr double kSizeTolerance = 0.3;  ///< of a move, as a share of each side

std::vector<double> scanTimes(const std::vector<mapping::Cloud>& clouds) {
  std::vector<double> times_s;
  for (const mapping::Cloud& cloud : clouds)
    if (cloud.time_s && cloud.has_pose) times_s.push_back(*cloud.time_s);
  std::sort(times_s.begin(), times_s.end());
  return times_s;
}

/// "the map has", or "until ... the map has": what is not asked about does not count.
std::string mapHas(const ChangeTimes& times) {
  return times.until_s ? "until " + dateTimeText(*times.until_s) + " the map has" : std::string("the map has");
}

double beginOfLastVisit(const std::vector<mapping::Cloud>& clouds, const ChangeTimes& times) {
  if (clouds.size() == 1)
    throw Error(ErrorKind::InvalidArgument,
                mapHas(times) + " one scan only: changes are told from scans of two visits");
  const std::vector<Visit> visits = visitsOf(clouds);
  if (visits.empty())
    throw Error(ErrorKind::InvalidArgument,
                times.until_s ? mapHas(times) + " no scan with a time and a pose"
                              : "no cloud of the map has a time and a pose, so nothing tells what came later: give "
                                "times with the scans (times.txt, or a manifest)");
  if (visits.size() == 1)
    throw Error(ErrorKind::InvalidArgument,
                mapHas(times) + " scans without a pause of half an hour only: tell from when on they count as later",
                Remedy::NameTime);
  return visits.back().begin_s;
}

/// `times_s`: of the scans that are asked about; `all_s`: of all.
void requireBothSides(const std::vector<double>& times_s, const std::vector<double>& all_s, double since_s,
                      const ChangeTimes& times) {
  if (times.until_s && *times.until_s < since_s)
    throw Error(ErrorKind::InvalidArgument, "the changes since " + dateTimeText(since_s) + " are asked for until " +
                                                dateTimeText(*times.until_s) + ", which is earlier");
  const auto after = std::lower_bound(times_s.begin(), times_s.end(), since_s);
  if (after != times_s.begin() && after != times_s.end()) return;
  const std::string known =
      all_s.empty() ? "no cloud has both"
                    : "they were taken from " + dateTimeText(all_s.front()) + " to " + dateTimeText(all_s.back());
  const std::string until = times.until_s ? " and until " + dateTimeText(*times.until_s) : std::string();
  throw Error(ErrorKind::InvalidArgument, "no cloud with time and pose lies " +
                                              std::string(after == times_s.end() ? "at or after " : "before ") +
                                              dateTimeText(since_s) + until + ": " + known);
}

bool areOfOneSize(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  constexpr double kSmall_m = 0.2;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(a[axis] - b[axis]) > kSmall_m + kSizeTolerance * std::max(a[axis], b[axis])) return false;
  return true;
}

/// Whether what vanished may be what appeared: two objects, or parts of such, of one class and nearly one size, of
/// which no visit saw both.
bool mayBeOne(const mapping::MapReader& map, const ChangedThing& gone, const ChangedThing& come) {
  return gone.object && come.object && gone.object != come.object && !gone.has_more_parts && !come.has_more_parts &&
         !haveCommon(gone.visits, come.visits) && areOfOneSize(gone.box.sizes(), come.box.sizes()) &&
         map.classOf(*gone.object) == map.classOf(*come.object);
}

/// Pairs what vanished with what appeared, nearest first.
std::vector<SiteChange> withMoves(const mapping::MapReader& map, const ChangedThings& all) {
  const auto& [gone, come] = all;
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < gone.size(); ++i)
    for (std::size_t j = 0; j < come.size(); ++j) {
      const double distance = (gone[i].box.center() - come[j].box.center()).norm();
      if (distance <= kMaxMove_m && mayBeOne(map, gone[i], come[j])) pairs.emplace_back(distance, i, j);
    }
  std::sort(pairs.begin(), pairs.end());
  std::vector<bool> left(gone.size(), false), arrived(come.size(), false);
  std::vector<SiteChange> changes;
  for (const auto& [distance, i, j] : pairs) {
    if (left[i] || arrived[j]) continue;
    left[i] = arrived[j] = true;
    changes.push_back({SiteChange::Kind::Moved, gone[i], come[j], distance});
  }
  for (std::size_t i = 0; i < gone.size(); ++i)
    if (!left[i]) changes.push_back({SiteChange::Kind::Vanished, gone[i], std::nullopt, 0});
  for (std::size_t j = 0; j < come.size(); ++j)
    if (!arrived[j]) changes.push_back({SiteChange::Kind::Appeared, come[j], std::nullopt, 0});
  std::stable_sort(changes.begin(), changes.end(),
                   [](const SiteChange& a, const SiteChange& b) { return a.thing.cluxels < b.thing.cluxels; });
  return changes;
}

SiteChanges changesBetween(const mapping::MapReader& map, const ComparedTimes& times, unsigned threads,
                           std::size_t max_cluxels) {
  ChangeSurvey survey = surveyOf(map, times, max_cluxels, threads);
  SiteChanges found{times, {}, {}};
  found.changes = withMoves(map, changedThings(survey));
  found.states = std::move(survey.states);
  return found;
}

ChangeJson boxJson(const Eigen::AlignedBox3d& box) {
  const auto rounded = [](const Eigen::Vector3d& v) {
    return ChangeJson{std::round(v.x() * 1000) / 1000, std::round(v.y() * 1000) / 1000,
                      std::round(v.z() * 1000) / 1000};
  };
  return {{"min", rounded(box.min())}, {"max", rounded(box.max())}};
}

ChangeJson objectJson(const mapping::MapReader& map, std::uint32_t number) {
  return {{"object", rdf::iriOfObject(map.objectIds()[number])},
          {"number", number},
          {"class", map.classNames().nameOf(map.classOf(number))}};
}

ChangeJson thingJson(const mapping::MapReader& map, const ChangedThing& thing) {
  ChangeJson json{{"object", nullptr}, {"number", nullptr}, {"class", nullptr}};
  if (thing.object) json = objectJson(map, *thing.object);
  json["part"] = thing.is_part;
  json["cluxels"] = thing.cluxels.size();
  json["box_m"] = boxJson(thing.box);
  return json;
}

}  // namespace

std::string_view nameOf(SiteChange::Kind kind) {
  constexpr std::array<std::string_view, 3> kNames{"vanished", "appeared", "moved"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::vector<Visit> visitsOf(const std::vector<mapping::Cloud>& clouds) {
  const std::vector<double> times_s = scanTimes(clouds);
  const Visits numbers(times_s, std::numeric_limits<double>::infinity());
  std::vector<Visit> visits;
  for (std::uint32_t scan = 0; scan < times_s.size(); ++scan) {
    if (numbers.ofScan(scan) == visits.size()) visits.push_back({times_s[scan], times_s[scan], 0});
    visits.back().end_s = times_s[scan];
    ++visits.back().scans;
  }
  return visits;
}

SiteChanges changesIn(const mapping::MapReader& map, const ChangeTimes& times, unsigned threads,
                      std::size_t max_cluxels) {
  ComparedTimes compared;
  if (times.until_s) compared.until_s = *times.until_s;
  const std::vector<mapping::Cloud> clouds = cloudsWithin(map.clouds(), compared);
  compared.since_s = times.since_s ? *times.since_s : beginOfLastVisit(clouds, times);
  requireBothSides(scanTimes(clouds), scanTimes(map.clouds()), compared.since_s, times);
  return changesBetween(map, compared, threads, max_cluxels);
}

std::vector<SiteChanges> changesOfVisits(const mapping::MapReader& map, unsigned threads) {
  constexpr std::size_t kVisitsBefore = 4;  // so that the cost does not grow with the square of the visits
  const std::vector<Visit> visits = visitsOf(map.clouds());
  std::vector<SiteChanges> found;
  for (std::size_t i = 1; i < visits.size(); ++i)
    found.push_back(changesBetween(map,
                                   {.since_s = visits[i].begin_s,
                                    .from_s = visits[i - std::min(i, kVisitsBefore)].begin_s,
                                    .until_s = visits[i].end_s},
                                   threads, kRegionCluxels));
  return found;
}

namespace {

/// "3 changes"
std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return std::to_string(count) + " " + std::string(count == 1 ? one : many);
}

}  // namespace

std::vector<std::uint32_t> objectsThatDifferByStates(const SiteChanges& changes) {
  std::vector<const ChangedThing*> gone, come;
  for (const SiteChange& change : changes.changes) {
    (change.kind == SiteChange::Kind::Appeared ? come : gone).push_back(&change.thing);
    if (change.now) come.push_back(&*change.now);
  }
  std::vector<std::uint32_t> objects;
  for (const ObjectStates& states : changes.states) {
    const bool went = states.before == PresenceState::Present && states.after == PresenceState::Absent;
    const bool came = states.before == PresenceState::Absent && states.after == PresenceState::Present;
    const auto tells = [&](const ChangedThing* thing) {
      return thing->object == states.object || thing->box.contains(states.box.center());
    };
    if ((went && std::none_of(gone.begin(), gone.end(), tells)) ||
        (came && std::none_of(come.begin(), come.end(), tells)))
      objects.push_back(states.object);
  }
  return objects;
}

std::string summaryOf(const SiteChanges& changes) {
  const auto objectsWhere = [&](const auto& holds) {
    return static_cast<std::size_t>(std::count_if(changes.states.begin(), changes.states.end(), holds));
  };
  const auto isThere = [](const ObjectStates& states) { return states.after == PresenceState::Present; };
  const ComparedTimes& times = changes.times;
  std::string text = "since " + dateTimeText(times.since_s);
  if (times.endsEarly()) text += " until " + dateTimeText(times.until_s);
  text += ": " + counted(changes.changes.size(), "change", "changes") + "; " +
          counted(objectsWhere(isThere), "object is", "objects are") + " there, " +
          counted(objectsWhere(wasNotObservedAgain), "was", "were") + " not observed again";
  if (const std::size_t more = objectsThatDifferByStates(changes).size(); more > 0)
    text += "; " + std::to_string(more) + " more came or went by the states alone, which is less sure";
  return text;
}

std::string nameOf(const mapping::MapReader& map, const ChangedThing& thing) {
  return (thing.is_part ? "part of " : "") + thingName(map, thing.object.value_or(kUnnamedThing));
}

std::vector<PartStates> statesOfParts(const SiteChanges& changes) {
  std::map<std::uint32_t, const ObjectStates*> whole;
  for (const ObjectStates& states : changes.states) whole[states.object] = &states;
  std::vector<PartStates> parts;
  const auto add = [&](const ChangedThing& thing, const PartStates& states) {
    const auto object = thing.object ? whole.find(*thing.object) : whole.end();
    if (object == whole.end()) return;
    const bool is_same = states.after == PresenceState::Absent ? object->second->after == PresenceState::Absent
                                                               : object->second->before == PresenceState::Absent;
    if (!is_same) parts.push_back(states);
  };
  for (const SiteChange& change : changes.changes) {
    if (change.kind != SiteChange::Kind::Appeared)
      add(change.thing, {&change.thing, PresenceState::Present, PresenceState::Absent});
    const ChangedThing* now = change.kind == SiteChange::Kind::Appeared ? &change.thing
                              : change.now                              ? &*change.now
                                                                        : nullptr;
    if (now != nullptr) add(*now, {now, PresenceState::Absent, PresenceState::Present});
  }
  return parts;
}

namespace {

/// To whole microseconds, as the times of scans.
double timeOfScans(double seconds, const std::string& text) {
  if (hasCalendarYear(seconds)) return toMicroseconds(seconds);
  throw Error(
      ErrorKind::InvalidArgument,
      "'" + text + "' lies outside of the years 1 to 9999: scans have times within them, in seconds since 1970");
}

}  // namespace

double timeNamed(const std::string& text) {
  if (const auto seconds = finiteNumber(text)) return timeOfScans(*seconds, text);
  auto time = sparql::parseCalendar(sparql::CalendarKind::DateTime, text);
  if (!time) time = sparql::parseCalendar(sparql::CalendarKind::Date, text);
  if (!time)
    throw Error(ErrorKind::InvalidArgument,
                "'" + text + "' is no time: write 2023-11-15T22:13:20Z, 2023-11-15, or seconds since 1970");
  return timeOfScans(time->timeline().toDouble(), text);
}

std::string changesJson(const mapping::MapReader& map, const SiteChanges& found) {
  ChangeJson json{
      {"since", dateTimeText(found.times.since_s)}, {"changes", ChangeJson::array()}, {"states", ChangeJson::array()}};
  if (found.times.endsEarly()) json["until"] = dateTimeText(found.times.until_s);
  for (const SiteChange& change : found.changes) {
    ChangeJson entry = thingJson(map, change.thing);
    entry["change"] = nameOf(change.kind);
    if (change.now) {
      entry["now"] = thingJson(map, *change.now);
      entry["distance"] = std::round(change.distance_m * 1000) / 1000;
    }
    json["changes"].push_back(std::move(entry));
  }
  for (const ObjectStates& states : found.states) {
    ChangeJson entry = objectJson(map, states.object);
    entry["box_m"] = boxJson(states.box);
    entry["before"] = nameOf(states.before);
    entry["after"] = nameOf(states.after);
    entry["log_odds_before"] = std::round(states.log_odds_before * 100) / 100;
    entry["log_odds_after"] = std::round(states.log_odds_after * 100) / 100;
    entry["coverage_before"] = std::round(states.coverage_before * 100) / 100;
    entry["coverage_after"] = std::round(states.coverage_after * 100) / 100;
    json["states"].push_back(std::move(entry));
  }
  json["parts"] = ChangeJson::array();
  for (const PartStates& states : statesOfParts(found)) {
    ChangeJson entry = objectJson(map, *states.part->object);
    entry["cluxels"] = states.part->cluxels.size();
    entry["box_m"] = boxJson(states.part->box);
    entry["before"] = nameOf(states.before);
    entry["after"] = nameOf(states.after);
    json["parts"].push_back(std::move(entry));
  }
  return json.dump(1) + "\n";
}

}  // namespace cluxel::tasks
