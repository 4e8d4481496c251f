// SPDX-License-Identifier: Apache-2.0
// Changes between visits as values: numbers of objects and clouds become IRIs and ids.
#include "api/change_values.hpp"
#include "api/task_values.hpp"
#include "api/way_values.hpp"
#include "rdf/map_iris.hpp"
#include "tasks/changes/changed_points.hpp"
#include "tasks/changes/site_changes.hpp"

namespace cluxel {

static_assert(static_cast<int>(PresenceState::Present) == static_cast<int>(perception::PresenceState::Present) &&
              static_cast<int>(PresenceState::Absent) == static_cast<int>(perception::PresenceState::Absent) &&
              static_cast<int>(PresenceState::NotObserved) == static_cast<int>(perception::PresenceState::NotObserved));
static_assert(static_cast<int>(SiteChangeKind::Vanished) == static_cast<int>(tasks::SiteChange::Kind::Vanished) &&
              static_cast<int>(SiteChangeKind::Appeared) == static_cast<int>(tasks::SiteChange::Kind::Appeared) &&
              static_cast<int>(SiteChangeKind::Moved) == static_cast<int>(tasks::SiteChange::Kind::Moved));

namespace {

double secondsOf(const Time& time) {
  const auto* seconds = std::get_if<double>(&time);
  return tasks::timeNamed(seconds != nullptr ? exactText(*seconds) : std::get<std::string>(time));
}

PresenceState stateOf(perception::PresenceState state) {
  return static_cast<PresenceState>(state);
}

Position cornerOf(const Eigen::Vector3d& p_map) {
  return {p_map.x(), p_map.y(), p_map.z()};
}

ChangedThing valueOf(const mapping::MapReader& map, const tasks::ChangedThing& found) {
  ChangedThing thing;
  if (found.object) {
    thing.object = rdf::iriOfObject(map.objectIds()[*found.object]);
    thing.class_name = map.classNames().nameOf(map.classOf(*found.object));
  }
  thing.is_part = found.is_part;
  thing.cluxel_count = found.cluxels.size();
  thing.min = cornerOf(found.box.min());
  thing.max = cornerOf(found.box.max());
  return thing;
}

SiteChange valueOf(const mapping::MapReader& map, const tasks::SiteChange& found) {
  SiteChange change;
  change.kind = static_cast<SiteChangeKind>(found.kind);
  change.thing = valueOf(map, found.thing);
  if (found.now) change.now = valueOf(map, *found.now);
  change.distance_m = found.distance_m;
  return change;
}

ObjectStates valueOf(const mapping::MapReader& map, const tasks::ObjectStates& found) {
  ObjectStates states;
  states.iri = rdf::iriOfObject(map.objectIds()[found.object]);
  states.number = found.object;
  states.class_name = map.classNames().nameOf(map.classOf(found.object));
  states.before = stateOf(found.before);
  states.after = stateOf(found.after);
  states.log_odds_before = found.log_odds_before;
  states.log_odds_after = found.log_odds_after;
  states.coverage_before = found.coverage_before;
  states.coverage_after = found.coverage_after;
  states.min = cornerOf(found.box.min());
  states.max = cornerOf(found.box.max());
  return states;
}

ChangedPoints valueOf(const std::vector<tasks::ChangedPoint>& found) {
  ChangedPoints points;
  for (const tasks::ChangedPoint& point : found) {
    const std::string id = point.cloud.hex();
    if (points.cloud_ids.empty() || points.cloud_ids.back() != id) points.cloud_ids.push_back(id);
    points.cloud.push_back(static_cast<std::uint32_t>(points.cloud_ids.size() - 1));
    points.point.push_back(point.point);
    points.change.push_back(point.change);
    points.is_gone.push_back(point.is_gone ? 1 : 0);
  }
  return points;
}

}  // namespace

SiteChanges changesIn(const mapping::MapReader& map, const VisitOptions& options) {
  tasks::ChangeTimes times;
  if (options.since) times.since_s = secondsOf(*options.since);
  if (options.until) times.until_s = secondsOf(*options.until);
  const tasks::SiteChanges found = tasks::changesIn(map, times, threadCountOf(options.threads));
  SiteChanges answer;
  answer.since_s = found.times.since_s;
  if (found.times.endsEarly()) answer.until_s = found.times.until_s;
  answer.summary = tasks::summaryOf(found);
  for (const tasks::SiteChange& change : found.changes) answer.changes.push_back(valueOf(map, change));
  for (const tasks::ObjectStates& states : found.states) answer.states.push_back(valueOf(map, states));
  for (const tasks::PartStates& part : tasks::statesOfParts(found))
    answer.parts.push_back({valueOf(map, *part.part), stateOf(part.before), stateOf(part.after)});
  if (options.with_points) answer.points = valueOf(tasks::changedPoints(map, found));
  return answer;
}

}  // namespace cluxel
