// SPDX-License-Identifier: Apache-2.0
// `cluxel changes`: what vanished, appeared and moved between visits.
#include <cmath>

#include "app/command.hpp"
#include "app/map_condition.hpp"
#include "app/shared_options.hpp"
#include "base/file_pieces.hpp"
#include "mapping/facts/map_facts.hpp"
#include "tasks/changes/changed_points.hpp"
#include "tasks/changes/site_changes.hpp"
#include "tasks/ways/way_report.hpp"

namespace cluxel::app {

namespace {

struct ChangesArguments {
  fs::path map, points;
  std::string since, until;
  bool states = false, allow_unfinished = false;
};

/// "absent 97 %": what is known of how many of its places.
std::string stateText(perception::PresenceState state, double coverage) {
  return std::string(nameOf(state)) + " " + std::to_string(std::lround(coverage * 100)) + " %";
}

void printState(const std::string& before, const std::string& after, const std::string& thing) {
  std::printf("%-18s -> %-18s  %s\n", before.c_str(), after.c_str(), thing.c_str());
}

void printStates(const mapping::MapReader& map, const tasks::SiteChanges& found) {
  for (const tasks::ObjectStates& states : found.states)
    printState(stateText(states.before, states.coverage_before), stateText(states.after, states.coverage_after),
               tasks::thingName(map, states.object));
  for (const tasks::PartStates& states : statesOfParts(found))
    printState(std::string(nameOf(states.before)), std::string(nameOf(states.after)),
               "part of " + tasks::thingName(map, *states.part->object));
}

void printChanges(const mapping::MapReader& map, const tasks::SiteChanges& found) {
  std::puts(summaryOf(found).c_str());
  for (const tasks::SiteChange& change : found.changes) {
    std::printf("%-8s  %s", std::string(nameOf(change.kind)).c_str(), nameOf(map, change.thing).c_str());
    if (change.now) std::printf(" by %.1f m, now %s", change.distance_m, nameOf(map, *change.now).c_str());
    const Eigen::Vector3d at = change.thing.box.center();
    std::printf(" at (%.1f, %.1f)\n", at.x(), at.y());
  }
}

void writePoints(const fs::path& file, const mapping::MapReader& map, const tasks::SiteChanges& found) {
  const std::vector<tasks::ChangedPoint> points = changedPoints(map, found);
  writeFileInPieces(file, [&](const auto& write) { writeChangedPoints(points, map.clouds(), write); });
}

ExitCode changes(const ChangesArguments& arguments, Session& session) {
  if (!arguments.points.empty()) refuseToReplaceMap(arguments.points);
  const mapping::MapReader map(arguments.map);
  noteUnfinished(arguments.map, map.isFinished(), arguments.allow_unfinished, session);
  tasks::ChangeTimes times;
  if (!arguments.since.empty()) times.since_s = tasks::timeNamed(arguments.since);
  if (!arguments.until.empty()) times.until_s = tasks::timeNamed(arguments.until);
  const tasks::SiteChanges found = tasks::changesIn(map, times, session.threadCount());
  if (!arguments.points.empty()) writePoints(arguments.points, map, found);
  if (session.json)
    print(tasks::changesJson(map, found));
  else if (arguments.states)
    printStates(map, found);
  else
    printChanges(map, found);
  return found.changes.empty() ? ExitCode::NoRows : ExitCode::Done;
}

}  // namespace

void addChanges(CLI::App& app, Session& session) {
  auto arguments = std::make_shared<ChangesArguments>();
  CLI::App* command = app.add_subcommand("changes", "list what vanished, appeared and moved between visits to a place");
  command->add_option("map", arguments->map, "the map")->required()->check(named());
  command->add_option(
      "--since", arguments->since,
      "scans from this time on are later: 2023-11-15T22:13:20Z, or seconds since 1970 [the last visit]");
  command->add_option("--until", arguments->until, "scans after this time do not count [the last scan]");
  command->add_flag("--states", arguments->states,
                    "list every object and changed part: present, absent or not observed, before and after");
  command
      ->add_option("--points", arguments->points,
                   "write the measured points of what vanished and appeared, as CSV: cloud,source,point,change,kind")
      ->check(named());
  addAllowUnfinished(*command, arguments->allow_unfinished);
  onRun(*command, session, [arguments, &session] { return changes(*arguments, session); });
}

}  // namespace cluxel::app
