// SPDX-License-Identifier: Apache-2.0
// The tasks route, reach and search, by name and parameters.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/nearest_name.hpp"
#include "serve/map_resources.hpp"
#include "serve/refusal.hpp"
#include "tasks/search/search_tour.hpp"
#include "tasks/ways/way_report.hpp"

namespace cluxel::serve {

namespace {

struct TaskParameter {
  const char *name, *unit, *help;
};

/// What all tasks take.
const std::vector<TaskParameter> kWayParameters{{"without", "", "a class, Movable or Static; may be repeated"},
                                                {"width", "m", "free width that is needed"},
                                                {"maxSlope", "", "rise over run"},
                                                {"maxStep", "m", "height of a kerb that is passed"}};

struct Task {
  const char *name, *title;
  std::vector<TaskParameter> parameters;
};

const std::vector<Task>& knownTasks() {
  static const std::vector<Task> all{
      {"route",
       "ways over the ground, or what closes them",
       {{"from", "m", "X,Y or an object"},
        {"to", "m", "X,Y or an object"},
        {"near", "", "a class: the way stays near such objects"},
        {"alternatives", "", "how many routes to look for"}}},
      {"reach",
       "what is within some minutes' walk",
       {{"from", "m", "X,Y or an object"}, {"minutes", "min", "of the walk"}, {"speed", "m/s", "of the walk"}}},
      {"search",
       "where to look first for objects of a class",
       {{"for", "", "the class"},
        {"from", "m", "X,Y or an object"},
        {"budget", "m", "how long the walk may be"},
        {"stops", "", "at most so many"},
        {"view", "m", "how far an object is recognised"}}}};
  return all;
}

const Task& taskNamed(const std::string& name) {
  std::vector<std::string> known;
  for (const Task& task : knownTasks()) {
    if (task.name == name) return task;
    known.emplace_back(task.name);
  }
  const std::string hint = suggestion(name, known);
  throw Refusal(404, "there is no task '" + name + "'" + (hint.empty() ? "" : "; " + hint));
}

std::string required(const Parameters& parameters, const char* name) {
  const auto value = valueOf(parameters, name);
  if (!value || value->empty()) throw Refusal(400, std::string("the parameter ") + name + " is missing");
  return *value;
}

/// A number of a range; the default when it is absent.
double within(const Parameters& parameters, const char* name, double standard, double low, double high) {
  const double value = numberOf(parameters, name).value_or(standard);
  if (value >= low && value <= high) return value;
  throw Refusal(400, std::string("parameter ") + name + ": write a number from " + std::to_string(low) + " to " +
                         std::to_string(high));
}

tasks::WayRequest wayRequest(const Parameters& parameters) {
  tasks::WayRequest request;
  request.without = valuesOf(parameters, "without");
  request.near = valueOf(parameters, "near").value_or("");
  request.params.width_m = within(parameters, "width", request.params.width_m, 0, 20);
  request.params.max_slope = within(parameters, "maxSlope", request.params.max_slope, 0, 10);
  request.params.max_step_m = within(parameters, "maxStep", request.params.max_step_m, 0, 2);
  return request;
}

std::string routeText(const mapping::MapReader& map, const Parameters& parameters) {
  const Eigen::Vector2d from = tasks::placeNamed(map, required(parameters, "from"));
  const Eigen::Vector2d to = tasks::placeNamed(map, required(parameters, "to"));
  const auto count = static_cast<std::size_t>(within(parameters, "alternatives", 1, 1, 9));
  const tasks::PassableGrid grid = passableIn(map, wayRequest(parameters));
  return routesJson(map, grid.frame, findRoutes(grid, from, to, count));
}

std::string reachText(const mapping::MapReader& map, const Parameters& parameters) {
  const Eigen::Vector2d from = tasks::placeNamed(map, required(parameters, "from"));
  const double minutes = within(parameters, "minutes", 5, 0, 600),
               speed_m_s = within(parameters, "speed", 1.2, 0.01, 100);
  const tasks::WayRequest request = wayRequest(parameters);
  const tasks::PassableGrid grid = passableIn(map, request);
  const std::vector<double> walk_m = walkLengths(grid, from, minutes * 60 * speed_m_s);
  const auto cells = std::count_if(walk_m.begin(), walk_m.end(), [](double length) { return std::isfinite(length); });
  return reachJson(map, objectsWithin(terrainOf(map, request.terrain), walk_m),
                   static_cast<double>(cells) * grid.frame.cell_m * grid.frame.cell_m, speed_m_s);
}

std::string searchText(const mapping::MapReader& map, const Parameters& parameters) {
  tasks::SearchRequest request;
  request.class_name = required(parameters, "for");
  request.from = valueOf(parameters, "from").value_or("");
  request.ways = wayRequest(parameters);
  request.search.view_m = within(parameters, "view", request.search.view_m, 1, 100);
  request.tour.budget_m = within(parameters, "budget", 0, 0, 1e6);
  request.tour.max_stops = static_cast<std::size_t>(within(parameters, "stops", 10, 1, 100));
  return searchJson(map, searchFor(map, request));
}

}  // namespace

HttpResponse answerTaskList() {
  nlohmann::ordered_json json{{"tasks", nlohmann::ordered_json::array()}};
  for (const Task& task : knownTasks()) {
    nlohmann::ordered_json entry{
        {"name", task.name}, {"title", task.title}, {"parameters", nlohmann::ordered_json::array()}};
    for (const auto* list : {&task.parameters, &kWayParameters})
      for (const TaskParameter& p : *list)
        entry["parameters"].push_back({{"name", p.name}, {"unit", p.unit}, {"help", p.help}});
    json["tasks"].push_back(std::move(entry));
  }
  return {200, "application/json", json.dump() + "\n", {}};
}

HttpResponse answerTask(ServedMap& map, const ResourceRequest& asked, const std::string& name) {
  const Task& task = taskNamed(name);
  std::vector<std::string> known;
  for (const auto* list : {&task.parameters, &kWayParameters})
    for (const TaskParameter& parameter : *list) known.emplace_back(parameter.name);
  requireKnown(asked.target.parameters, known);
  std::string text;
  map.withReader([&](const mapping::MapReader& reader) {
    const auto run = name == "route" ? routeText : name == "reach" ? reachText : searchText;
    text = run(reader, asked.target.parameters);
  });
  return {200, "application/json", text + "\n", {}};
}

}  // namespace cluxel::serve
