// SPDX-License-Identifier: Apache-2.0
// Inventory, register, next views and changes between visits as rows.
#include "tasks/ask/inventory_task.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "base/utc_time.hpp"
#include "mapping/facts/map_facts.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/ask/task_table.hpp"
#include "tasks/changes/site_changes.hpp"
#include "tasks/gone_things.hpp"
#include "tasks/search/next_view.hpp"
#include "tasks/ways/way_limits.hpp"
#include "tasks/ways/way_report.hpp"

namespace cluxel::tasks {

namespace {

using Kind = TaskParameter::Kind;

TaskCell measuredCell(double value) {
  return std::isnan(value) ? TaskCell() : TaskCell(value);
}

TaskCell namedCell(const std::string& text) {
  return text.empty() ? TaskCell() : TaskCell(text);
}

/// With the streets of a file, the column of the nearest one.
std::vector<QueryColumn> inventoryColumns(bool with_streets) {
  std::vector<QueryColumn> columns{{"kind", "text", "class of the object, ParkingRow or Sidewalk"},
                                   {"object", "IRI", "the object or way; absent for rows"},
                                   {"x", "m", "position in the map frame; of a tree its trunk"},
                                   {"y", "m", "position in the map frame"},
                                   {"height", "m", "top above the local ground"},
                                   {"crown", "m", "diameter of the circle that is as large as the crown from above"},
                                   {"width", "m", "of a row; of a sidewalk the median across it"},
                                   {"length", "m", "of a row or sidewalk"},
                                   {"count", "1", "vehicles of a row"}};
  if (with_streets)
    columns.insert(columns.begin() + 2, {"street", "text", "the nearest street; absent where none is near"});
  return columns;
}

TaskShape shapeOfItem(const InventoryItem& item) {
  if (item.line.size() > 1) return {TaskShape::Kind::Line, item.line};
  return {TaskShape::Kind::Point, {item.at}};
}

TaskParameter numberWithin(const Limits& limits, TaskParameter parameter) {
  parameter.min = limits.min;
  parameter.max = limits.max;
  return parameter;
}

TaskAnswer runNextView(const TaskContext& context, const TaskValues& values) {
  const mapping::MapReader& map = context.map;
  NextViewRequest request;
  request.from = values.text("from");
  request.is_doubtful = values.flag("doubtful");
  request.below = values.number("below");
  request.view_m = values.number("view");
  request.ways.params.width_m = values.number("width");
  request.ways.params.max_step_m = values.number("maxStep");
  request.tour.max_stops = values.whole("stops");
  request.tour.budget_m = values.number("budget");
  const NextViewAnswer found = nextViews(map, request);
  TaskAnswer answer;
  for (std::size_t i = 0; i < found.views.size(); ++i) {
    const NextView& view = found.views[i];
    const Eigen::Vector2d at = found.frame.centreOf(view.stop.cell);
    answer.rows.push_back({{static_cast<double>(i + 1), at.x(), at.y(), view.stop.walk_m, view.stop.total_m,
                            view.area_m2, static_cast<double>(view.objects.size()), view.stop.so_far},
                           {TaskShape::Kind::Point, {at}}});
    answer.rows.back().way = cornersOf(found.frame, view.stop.way);
    if (!context.with_reasons) continue;
    std::array<char, 96> line{};
    std::snprintf(line.data(), line.size(), "%.1f m2 that was not observed comes into sight", view.area_m2);
    answer.rows.back().why.emplace_back(line.data());
    for (std::size_t o = 0; o < view.objects.size(); ++o) {
      std::snprintf(line.data(), line.size(), ", confidence %.2f", view.confidences[o]);
      answer.rows.back().why.push_back("doubtful: " + thingName(map, view.objects[o]) + line.data());
    }
  }
  std::array<char, 128> note{};
  std::snprintf(note.data(), note.size(), "%.0f m2 not observed, %zu doubtful objects", found.unobserved_m2,
                found.doubtful);
  answer.notes.emplace_back(note.data());
  return answer;
}

TaskCell objectCell(const mapping::MapReader& map, const ChangedThing& thing) {
  return thing.object ? TaskCell(rdf::iriOfObject(map.objectIds()[*thing.object])) : TaskCell();
}

TaskCell classCell(const mapping::MapReader& map, const ChangedThing& thing) {
  return thing.object ? TaskCell(map.classNames().nameOf(map.classOf(*thing.object))) : TaskCell();
}

TaskRow changeRow(const mapping::MapReader& map, const SiteChange& change) {
  const Eigen::Vector2d at = change.thing.box.center().head<2>();
  const TaskCell part = change.thing.object ? TaskCell(change.thing.is_part ? "part" : "whole") : TaskCell();
  TaskRow row{{std::string(nameOf(change.kind)), objectCell(map, change.thing), classCell(map, change.thing), part,
               at.x(), at.y(), TaskCell(), TaskCell()},
              {TaskShape::Kind::Point, {at}}};
  if (change.now) {
    row.cells[6] = objectCell(map, *change.now), row.cells[7] = change.distance_m;
    row.shape = {TaskShape::Kind::Line, {at, change.now->box.center().head<2>()}};
  }
  return row;
}

/// How sure it is that an object was there before and is there now.
std::string presenceLine(const ObjectStates& states) {
  std::array<char, 160> line{};
  std::snprintf(line.data(), line.size(),
                "before: %s (log-odds %.1f, scans saw %.0f %% of its places), since: %s (%.1f, %.0f %%)",
                std::string(nameOf(states.before)).c_str(), states.log_odds_before, states.coverage_before * 100,
                std::string(nameOf(states.after)).c_str(), states.log_odds_after, states.coverage_after * 100);
  return line.data();
}

TaskRow unobservedRow(const mapping::MapReader& map, const ObjectStates& states) {
  const Eigen::Vector2d& at = states.centre;
  return {{std::string("not observed"), rdf::iriOfObject(map.objectIds()[states.object]),
           map.classNames().nameOf(map.classOf(states.object)), std::string("whole"), at.x(), at.y(), TaskCell(),
           TaskCell()},
          {TaskShape::Kind::Point, {at}}};
}

TaskAnswer runChanges(const TaskContext& context, const TaskValues& values) {
  const mapping::MapReader& map = context.map;
  ChangeTimes times;
  if (values.has("since")) times.since_s = timeNamed(values.text("since"));
  if (values.has("until")) times.until_s = timeNamed(values.text("until"));
  const SiteChanges found = changesIn(map, times, 1);
  std::map<std::uint32_t, const ObjectStates*> states_of;
  for (const ObjectStates& states : found.states) states_of[states.object] = &states;
  TaskAnswer answer;
  for (const SiteChange& change : found.changes) {
    answer.rows.push_back(changeRow(map, change));
    const auto states = change.thing.object ? states_of.find(*change.thing.object) : states_of.end();
    if (context.with_reasons && states != states_of.end())
      answer.rows.back().why.push_back((change.thing.is_part ? "of the object as a whole: " : "") +
                                       presenceLine(*states->second));
  }
  for (const ObjectStates& states : found.states) {
    if (!values.flag("unobserved") || !wasNotObservedAgain(states)) continue;
    answer.rows.push_back(unobservedRow(map, states));
    if (context.with_reasons) answer.rows.back().why.push_back(presenceLine(states));
  }
  answer.notes.push_back(summaryOf(found));
  return answer;
}

Task changesTask() {
  Task task;
  task.name = "changes";
  task.title = "What vanished, appeared or moved between visits?";
  task.parameters = {{"since", "", "",
                      "scans from this time on are later: 2023-11-15T22:13:20Z, or seconds since 1970; "
                      "without it the begin of the last visit"},
                     {"until", "", "", "scans after this time do not count; without it all count"},
                     {"unobserved", "", "false", "true: with the objects that were not observed again", Kind::Flag}};
  task.columns = {{"change", "text", "vanished, appeared, moved, not observed"},
                  {"object", "IRI", "the object that most of the change belongs to; absent when most belongs to none"},
                  {"class", "text", "of the object"},
                  {"extent", "text", "part or whole of the object"},
                  {"x", "m", "position in the map frame; of what moved, before"},
                  {"y", "m", "position in the map frame"},
                  {"now", "IRI", "of what moved: the object that is there now"},
                  {"distance", "m", "of what moved"}};
  task.has_reasons = true;
  task.run = runChanges;
  return task;
}

}  // namespace

namespace {

/// Tells of places that are asked for and that none of the map's SPARQL rules makes.
std::optional<std::string> noteOfMissingRules(const mapping::MapReader& map, const InventoryParams& params) {
  const mapping::MapInputs inputs = map.inputs();
  const auto is_made = [&](const char* class_name) {
    return std::any_of(inputs.sparql_rules.begin(), inputs.sparql_rules.end(),
                       [&](const mapping::NamedText& rule) { return rule.text.find(class_name) != std::string::npos; });
  };
  std::string missing;
  if (params.with_rows && !is_made("ParkingRow")) missing = "parking rows";
  if (params.with_sidewalks && !is_made("Sidewalk")) missing += missing.empty() ? "sidewalks" : " and sidewalks";
  if (missing.empty()) return std::nullopt;
  return missing +
         " are not listed: the map was built without SPARQL rules that make them; apply the rule files of "
         "rules/ that end in .rq to the map";
}

/// Tells of a file of streets that has none near the things: most often its coordinates are not what they should be.
std::optional<std::string> noteOfFarStreets(double nearest_m, double within_m) {
  constexpr double other_place_m = 10'000;
  if (std::isnan(nearest_m) || nearest_m <= within_m) return std::nullopt;
  std::array<char, 160> line{};
  std::snprintf(line.data(), line.size(), "no street lies within %.0f m of what is listed; the nearest is %.0f m away",
                within_m, nearest_m);
  if (!std::isfinite(nearest_m))
    std::snprintf(line.data(), line.size(), "no street lies where the map's coordinate system is defined");
  std::string note = line.data();
  if (nearest_m > other_place_m) note += ": are longitude and latitude exchanged? GeoJSON has the longitude first";
  return note;
}

/// Tells how much is left out, because later scans show it to be gone.
void addNotesOfGone(const mapping::MapReader& map, std::size_t rows_left_out, std::vector<std::string>& notes) {
  const std::vector<bool> is_gone = goneAmong(map);
  if (const auto gone = std::count(is_gone.begin(), is_gone.end(), true); gone > 0)
    notes.push_back("without " + std::to_string(gone) + " objects of all classes that later scans show to be gone");
  static_assert(kFewestInBrokenRow == 3, "the note names the number");
  if (rows_left_out > 0)
    notes.push_back("without " + std::to_string(rows_left_out) +
                    " parking rows of which fewer than three vehicles are left");
}

/// Which of the places that rules derive a register asks for.
InventoryParams placesAmong(const std::vector<RegisterEntry>& entries) {
  const auto names = [&](const char* place) {
    return std::any_of(entries.begin(), entries.end(), [iri = rdf::vocabulary::clx(place)](const RegisterEntry& entry) {
      return entry.class_iri == iri;
    });
  };
  return {.classes = {}, .with_rows = names("ParkingRow"), .with_sidewalks = names("Sidewalk")};
}

}  // namespace

std::vector<std::string> notesOf(const mapping::MapReader& map, const InventoryParams& params,
                                 const Inventory& inventory) {
  std::vector<std::string> notes;
  if (auto missing = noteOfMissingRules(map, params)) notes.push_back(std::move(*missing));
  if (auto far = noteOfFarStreets(inventory.nearest_street_m, params.street_within_m)) notes.push_back(std::move(*far));
  addNotesOfGone(map, inventory.rows_left_out, notes);
  return notes;
}

TaskAnswer inventoryAnswer(const mapping::MapReader& map, const InventoryParams& params,
                           const std::vector<Street>& streets) {
  TaskAnswer answer{inventoryColumns(!streets.empty()), {}};
  std::map<std::string, std::size_t> counts;
  const Inventory inventory = inventoryOf(map, params, streets);
  for (const InventoryItem& item : inventory.items) {
    ++counts[item.kind];
    const TaskCell count = isRow(item) ? TaskCell(static_cast<double>(item.count)) : TaskCell();
    answer.rows.push_back({{item.kind, namedCell(item.object), item.at.x(), item.at.y(), measuredCell(item.height_m),
                            measuredCell(item.crown_m), measuredCell(item.width_m), measuredCell(item.length_m), count},
                           shapeOfItem(item)});
    auto& cells = answer.rows.back().cells;
    if (!streets.empty()) cells.insert(cells.begin() + 2, namedCell(item.street));
  }
  std::string note;
  for (const auto& [kind, count] : counts) note += (note.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
  if (!note.empty()) answer.notes.push_back(note);
  for (std::string& other : notesOf(map, params, inventory)) answer.notes.push_back(std::move(other));
  return answer;
}

TaskAnswer registerAnswer(const mapping::MapReader& map, const InventoryParams& params,
                          const std::vector<RegisterEntry>& entries, const RegisterParams& comparison) {
  const RegisterItems things = registerItems(map, params, entries);
  const std::vector<RegisterItem>& items = things.items;
  TaskAnswer answer{{{"status", "text", "matched, missing in the map, not observed, not in the register"},
                     {"entry", "text", "id in the register"},
                     {"object", "IRI", "in the map"},
                     {"kind", "text", "class: the register's where it has one"},
                     {"x", "m", "position in the map frame: the register's where it has one"},
                     {"y", "m", "position in the map frame"},
                     {"distance", "m", "between entry and object"},
                     {"heightDifference", "m", "the map's height less the register's"}},
                    {}};
  std::map<std::string, std::size_t> counts;
  std::vector<RegisterRow> rows = compareWith(entries, items, comparison);
  tellMissing(map, entries, items, comparison, rows);
  for (const RegisterRow& row : rows) {
    const RegisterEntry* entry = row.entry ? &entries[*row.entry] : nullptr;
    const InventoryItem* item = row.item ? &items[*row.item].thing : nullptr;
    const Eigen::Vector2d at = entry != nullptr ? entry->at : item->at;
    const bool has_heights = entry != nullptr && item != nullptr && entry->height_m;
    ++counts[nameOf(row.status)];
    answer.rows.push_back(
        {{std::string(nameOf(row.status)), entry != nullptr ? namedCell(entry->id) : TaskCell(),
          item != nullptr ? namedCell(item->object) : TaskCell(),
          entry != nullptr ? map.classNames().nameOf(entry->class_iri) : item->kind, at.x(), at.y(),
          measuredCell(row.distance_m), has_heights ? measuredCell(item->height_m - *entry->height_m) : TaskCell()},
         {TaskShape::Kind::Point, {at}}});
  }
  std::string note;
  for (const auto& [status, count] : counts) note += (note.empty() ? "" : ", ") + std::to_string(count) + " " + status;
  answer.notes.push_back(note);
  const InventoryParams places = placesAmong(entries);
  if (const auto missing = noteOfMissingRules(map, places)) answer.notes.push_back(*missing);
  addNotesOfGone(map, things.rows_left_out, answer.notes);
  return answer;
}

std::vector<Task> surveyTasks() {
  Task inventory;
  inventory.name = "inventory";
  inventory.title = "Which signs, lamps, trees, parked vehicles and sidewalks are there, and how large are they?";
  inventory.parameters = {{"kind", "", "", "a class, ParkingRow or Sidewalk; else street furniture, trees and both",
                           Kind::Class, false, true}};
  inventory.columns = inventoryColumns(false);
  inventory.run = [](const TaskContext& context, const TaskValues& values) {
    return inventoryAnswer(context.map, inventoryOfKinds(context.map, values.all("kind")));
  };
  Task view;
  view.name = "next-view";
  view.title = "Where should I stand next to see most of what was not observed, or to settle doubtful objects?";
  view.parameters = {
      {"from", "m", "", "X,Y or an object; without it where the last scan was taken", Kind::Place},
      {"doubtful", "", "false", "true: look at doubtful objects", Kind::Flag},
      {"below", "1", "0.7", "an object of less confidence is doubtful", Kind::Number, false, false, 0, 1},
      numberWithin(kView_m, {"view", "m", "15", "distance within which a view is good enough", Kind::Number}),
      numberWithin(kTourStops, {"stops", "1", "5", "largest number of stops", Kind::WholeNumber}),
      numberWithin(kBudget_m, {"budget", "m", "0", "largest length of the walk; 0: no limit", Kind::Number}),
      numberWithin(kWidth_m, {"width", "m", "0.6", "free width that is needed", Kind::Number}),
      numberWithin(kMaxStep_m, {"maxStep", "m", "0.15", "height of a kerb that can be crossed", Kind::Number})};
  view.columns = {{"stop", "1", "number of the stop on the walk"},
                  {"x", "m", "position in the map frame"},
                  {"y", "m", "position in the map frame"},
                  {"walk", "m", "from the stop before"},
                  {"total", "m", "from the start"},
                  {"area", "m2", "area that was not observed and comes into sight"},
                  {"objects", "1", "doubtful objects that come into sight"},
                  {"soFar", "1", "share of everything to be seen that is in sight from here or from earlier stops"}};
  view.has_reasons = true;
  view.run = runNextView;
  return {inventory, view, changesTask()};
}

}  // namespace cluxel::tasks
