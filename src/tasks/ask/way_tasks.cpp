// SPDX-License-Identifier: Apache-2.0
// Routes, reach, search and cost maps as tasks.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "rdf/map_iris.hpp"
#include "tasks/ask/task_table.hpp"
#include "tasks/search/search_tour.hpp"
#include "tasks/ways/cost_map.hpp"
#include "tasks/ways/way_limits.hpp"
#include "tasks/ways/way_report.hpp"

namespace cluxel::tasks {

namespace {

using Kind = TaskParameter::Kind;

TaskParameter number(const char* name, const char* unit, const char* standard, const char* help, const Limits& limits) {
  return {name, unit, standard, help, Kind::Number, false, false, limits.min, limits.max};
}

TaskParameter whole(const char* name, const char* standard, const char* help, const Limits& limits) {
  return {name, "1", standard, help, Kind::WholeNumber, false, false, limits.min, limits.max};
}

TaskParameter place(const char* name, bool is_required, const char* help) {
  return {name, "m", "", help, Kind::Place, is_required};
}

/// The parameters that all ways have.
std::vector<TaskParameter> withWayParameters(std::vector<TaskParameter> own, bool with_width = true) {
  own.push_back({"without", "", "", "a class, Movable or Static: leave these objects out", Kind::Class, false, true});
  if (with_width) own.push_back(number("width", "m", "0.6", "free width that is needed", kWidth_m));
  own.push_back(number("maxSlope", "1", "0.12", "largest slope, rise over run", kMaxSlope));
  own.push_back(number("maxStep", "m", "0.06", "height of a kerb that can be crossed", kMaxStep_m));
  return own;
}

WayRequest wayRequestOf(const TaskValues& values) {
  WayRequest request;
  request.without = values.all("without");
  request.near = values.text("near");
  request.params.width_m = values.number("width");  // 0 where a task has no width
  request.params.max_slope = values.number("maxSlope");
  request.params.max_step_m = values.number("maxStep");
  return request;
}

TaskCell finite(double value) {
  return std::isfinite(value) ? TaskCell(value) : TaskCell();
}

std::string iriOfThing(const mapping::MapReader& map, std::uint32_t object) {
  return rdf::iriOfObject(map.objectIds()[object]);
}

std::string percentText(double share) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f %%", share * 100);
  return text.data();
}

TaskAnswer runRoute(const TaskContext& context, const TaskValues& values) {
  const mapping::MapReader& map = context.map;
  const Eigen::Vector2d from = placeNamed(map, values.text("from")), to = placeNamed(map, values.text("to"));
  const PassableGrid grid = passableIn(map, wayRequestOf(values));
  const RouteAnswer found = findRoutes(grid, from, to, values.whole("alternatives"));
  TaskAnswer answer;
  for (std::size_t i = 0; i < found.routes.size(); ++i) {
    const Route& route = found.routes[i];
    answer.rows.push_back({{static_cast<double>(i + 1), route.length_m, route.cost, route.climb_m, route.steepest,
                            route.highest_step_m, finite(route.narrowest_m)},
                           {TaskShape::Kind::Line, cornersOf(grid.frame, route.cells)}});
  }
  answer.is_negative = found.routes.empty();
  if (answer.is_negative) answer.notes.emplace_back("no way leads there; the way that crosses the least is closed by:");
  for (const Barrier& barrier : found.barriers) answer.notes.push_back("  " + barrierText(map, barrier));
  return answer;
}

TaskAnswer runReach(const TaskContext& context, const TaskValues& values) {
  const mapping::MapReader& map = context.map;
  const WayRequest request = wayRequestOf(values);
  const TerrainGrid terrain = terrainIn(map, request);
  const PassableGrid grid = passableIn(map, terrain, request);
  const double speed_m_s = values.number("speed"), reach_m = values.number("minutes") * 60 * speed_m_s;
  const LargeArray<double> walk_m = walkLengths(grid, placeNamed(map, values.text("from")), reach_m);
  TaskAnswer answer;
  for (const ReachedObject& reached : objectsWithin(terrain, walk_m, leftOut(map, request))) {
    const std::string iri = iriOfThing(map, reached.object);
    const Eigen::Vector2d at = placeNamed(map, iri);
    answer.rows.push_back({{iri, map.classNames().nameOf(map.objectClasses()[reached.object]), at.x(), at.y(),
                            reached.walk_m, reached.walk_m / speed_m_s},
                           {TaskShape::Kind::Point, {at}}});
  }
  const auto cells = std::count_if(walk_m.begin(), walk_m.end(), [](double length) { return std::isfinite(length); });
  std::array<char, 96> note{};
  std::snprintf(note.data(), note.size(), "%.0f m2 of ground within %.0f m",
                static_cast<double>(cells) * grid.frame.cell_m * grid.frame.cell_m, reach_m);
  answer.notes.emplace_back(note.data());
  return answer;
}

std::vector<std::string> reasonsOfStop(const SearchAnswer& found, const SearchStop& stop, const std::string& name) {
  std::vector<std::string> why;
  for (const auto& [reason, probability] : stop.shares) {
    std::string line = percentText(probability) + ": ";
    if (reason == kAnywhere) {
      line += "ground in sight that the map does not know well";
    } else {
      std::array<char, 64> within{};
      std::snprintf(within.data(), within.size(), " within %g m of a ", found.places[reason].within_m);
      line += "ground in sight" + (within.data() + found.reasons[reason]) + ", where " +
              percentText(found.places[reason].probability) + " of the objects of class " + name + " stand";
    }
    why.push_back(std::move(line));
  }
  return why;
}

TaskAnswer runSearch(const TaskContext& context, const TaskValues& values) {
  SearchRequest request;
  request.class_name = values.text("for");
  request.from = values.text("from");
  request.ways = wayRequestOf(values);
  request.ways.params.crosses_unobserved = values.flag("unobserved");
  request.search.view_m = values.number("view");
  request.search.detection = values.number("detection");
  request.tour.budget_m = values.number("budget");
  request.tour.max_stops = values.whole("stops");
  const SearchAnswer found = searchFor(context.map, request);
  TaskAnswer answer;
  for (std::size_t i = 0; i < found.stops.size(); ++i) {
    const SearchStop& stop = found.stops[i];
    const Eigen::Vector2d at = found.frame.centreOf(stop.cell);
    const TaskCell near = stop.reason == kAnywhere ? TaskCell() : TaskCell(found.reasons[stop.reason]);
    answer.rows.push_back(
        {{static_cast<double>(i + 1), at.x(), at.y(), stop.walk_m, stop.total_m, stop.probability, stop.so_far, near},
         {TaskShape::Kind::Point, {at}}});
    answer.rows.back().way = cornersOf(found.frame, stop.way);
    if (context.with_reasons) answer.rows.back().why = reasonsOfStop(found, stop, request.class_name);
  }
  answer.notes.push_back(std::to_string(found.known.size()) + " of class " + request.class_name + " known");
  return answer;
}

/// Axis-parallel rectangles that cover the marked cells: runs of a row, joined with equal runs of the rows before.
std::vector<Eigen::Vector2d> rectanglesOf(const GridFrame& frame, const LargeArray<std::uint8_t>& marked) {
  struct Run {
    int first, last, from_row, to_row;
  };
  std::vector<Run> open, done;
  for (int y = 0; y <= frame.rows; ++y) {
    std::vector<Run> here;
    for (int x = 0; y < frame.rows && x < frame.columns; ++x) {
      if (marked[frame.index(x, y)] == 0) continue;
      const bool goes_on = !here.empty() && here.back().last + 1 == x;
      if (goes_on) here.back().last = x;
      if (!goes_on) here.push_back({x, x, y, y});
    }
    for (const Run& run : open) {
      const auto same = std::find_if(here.begin(), here.end(),
                                     [&](const Run& h) { return h.first == run.first && h.last == run.last; });
      if (same == here.end()) done.push_back(run);
      if (same != here.end()) same->from_row = run.from_row;
    }
    open = std::move(here);
  }
  std::vector<Eigen::Vector2d> corners;
  for (const Run& run : done) {
    corners.emplace_back(frame.min_x + run.first * frame.cell_m, frame.min_y + run.from_row * frame.cell_m);
    corners.emplace_back(frame.min_x + (run.last + 1) * frame.cell_m, frame.min_y + (run.to_row + 1) * frame.cell_m);
  }
  return corners;
}

TaskAnswer runCostMap(const TaskContext& context, const TaskValues& values) {
  const PassableGrid grid = costMapGridIn(context.map, wayRequestOf(values));
  TaskAnswer answer;
  const double cell_m2 = grid.frame.cell_m * grid.frame.cell_m;
  for (const CellKind kind : {CellKind::Free, CellKind::Thing, CellKind::Step, CellKind::TooSteep, CellKind::TooNarrow,
                              CellKind::Unobserved}) {
    LargeArray<std::uint8_t> marked(grid.frame.size(), 0);
    for (std::uint32_t cell = 0; cell < grid.frame.size(); ++cell) marked[cell] = kindOf(grid, cell) == kind ? 1 : 0;
    const auto count = std::count(marked.begin(), marked.end(), 1);
    if (count == 0) continue;
    TaskShape shape;
    if (kind != CellKind::Unobserved) shape = {TaskShape::Kind::Area, rectanglesOf(grid.frame, marked)};
    answer.rows.push_back({{std::string(nameOf(kind)), static_cast<double>(count) * cell_m2}, std::move(shape)});
  }
  return answer;
}

Task routeTask() {
  return {"route",
          "Which ways lead from one place to another, or what closes them?",
          withWayParameters({place("from", true, "X,Y or an object"),
                             place("to", true, "X,Y or an object"),
                             {"near", "", "", "a class: the way stays near such objects", Kind::Class},
                             whole("alternatives", "1", "number of routes to look for", kAlternatives)}),
          {{"route", "1", "number, best first"},
           {"length", "m", "of the way"},
           {"cost", "1", "a metre costs 1, more on slopes, beside things and far from what it should stay near"},
           {"climb", "m", "sum of all that goes up"},
           {"steepest", "1", "largest slope, rise over run"},
           {"highestStep", "m", "of the kerbs that it crosses"},
           {"narrowest", "m", "free width at the narrowest place; absent without things"}},
          false,
          {},
          runRoute};
}

Task reachTask() {
  return {"reach",
          "What is within some minutes' walk?",
          withWayParameters({place("from", true, "X,Y or an object"),
                             number("minutes", "min", "5", "largest duration of the walk", kMinutes),
                             number("speed", "m/s", "1.2", "walking speed", kSpeed_m_s)}),
          {{"object", "IRI", "what is reached"},
           {"class", "text", "its class"},
           {"x", "m", "position in the map frame"},
           {"y", "m", "position in the map frame"},
           {"walk", "m", "length of the shortest walk"},
           {"seconds", "s", "its duration"}},
          false,
          {},
          runReach};
}

Task searchTask() {
  return {"search",
          "Where should I look first for objects of a class?",
          withWayParameters(
              {{"for", "", "", "the class", Kind::Class, true},
               place("from", false, "X,Y or an object; without it where the last scan was taken"),
               number("budget", "m", "0", "largest length of the walk; 0: no limit", kBudget_m),
               whole("stops", "10", "largest number of stops", kTourStops),
               number("view", "m", "10", "distance within which an object is recognised", kView_m),
               number("detection", "1", "0.8", "share of the objects of the class in view of a scan that the map holds",
                      kDetection),
               {"unobserved", "", "false", "true: the walk may cross ground that was not observed", Kind::Flag}}),
          {{"stop", "1", "number in the tour"},
           {"x", "m", "position in the map frame"},
           {"y", "m", "position in the map frame"},
           {"walk", "m", "from the stop before"},
           {"total", "m", "from the start"},
           {"probability", "1", "probability that the object is first seen from here"},
           {"soFar", "1", "probability that it is seen from here or from earlier stops"},
           {"near", "text", "the class of the usual place that most of it comes from; absent: anywhere"}},
          true,
          {},
          runSearch};
}

Task costMapTask() {
  return {"costmap",
          "Which ground is free, and what closes the rest?",
          withWayParameters({}, false),
          {{"kind", "text", "free, or why it is closed"}, {"area", "m2", "of its cells"}},
          false,
          {},
          runCostMap};
}

}  // namespace

std::vector<Task> wayTasks() {
  return {routeTask(), reachTask(), searchTask(), costMapTask()};
}

}  // namespace cluxel::tasks
