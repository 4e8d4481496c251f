// SPDX-License-Identifier: Apache-2.0
// `cluxel route`, `cluxel reach`, `cluxel costmap` and `cluxel search`: ways over a map's ground.
#include <algorithm>
#include <cmath>
#include <set>

#include "app/command.hpp"
#include "app/map_condition.hpp"
#include "app/shared_options.hpp"
#include "cluxel/error.hpp"
#include "tasks/search/place_learning.hpp"
#include "tasks/search/search_tour.hpp"
#include "tasks/ways/cost_map.hpp"
#include "tasks/ways/way_limits.hpp"
#include "tasks/ways/way_report.hpp"

namespace cluxel::app {

namespace {

struct WayArguments {
  fs::path map, output;
  std::string from, to, format, kind;
  tasks::WayRequest request;
  std::size_t alternatives = 1;
  double minutes = 5, speed_m_s = 1.2;
  bool local = false, allow_unfinished = false;
};

mapping::MapReader openMap(const WayArguments& arguments, Session& session) {
  mapping::MapReader map(arguments.map);
  noteUnfinished(arguments.map, map.isFinished(), arguments.allow_unfinished, session);
  return map;
}

void printRoutes(const mapping::MapReader& map, const tasks::RouteAnswer& answer) {
  for (std::size_t i = 0; i < answer.routes.size(); ++i) {
    const tasks::Route& route = answer.routes[i];
    std::printf("route %zu: %.1f m, climb %.1f m, steepest %.0f %%, highest step %.2f m", i + 1, route.length_m,
                route.climb_m, route.steepest * 100, route.highest_step_m);
    std::printf(std::isfinite(route.narrowest_m) ? ", narrowest %.1f m, cost %.1f\n" : ", %.0f things, cost %.1f\n",
                std::isfinite(route.narrowest_m) ? route.narrowest_m : 0.0, route.cost);
  }
  if (!answer.routes.empty()) return;
  std::printf("no way leads there; the way that crosses the least is closed by:\n");
  for (const tasks::Barrier& barrier : answer.barriers) std::printf("  %s\n", tasks::barrierText(map, barrier).c_str());
}

ExitCode route(const WayArguments& arguments, Session& session) {
  const mapping::MapReader map = openMap(arguments, session);
  const Eigen::Vector2d from = tasks::placeNamed(map, arguments.from), to = tasks::placeNamed(map, arguments.to);
  const tasks::PassableGrid grid = passableIn(map, arguments.request);
  const tasks::RouteAnswer answer = findRoutes(grid, from, to, arguments.alternatives);
  if (arguments.format == "geojson") {
    print(routesGeoJson(map, grid.frame, answer,
                        arguments.local ? tasks::ExportFrame::Local : tasks::ExportFrame::LongitudeLatitude));
    for (const tasks::Barrier& barrier : answer.barriers)
      session.console.note("the way is closed by " + tasks::barrierText(map, barrier));
  } else if (session.json) {
    print(routesJson(map, grid.frame, answer));
  } else {
    printRoutes(map, answer);
  }
  return answer.routes.empty() ? ExitCode::NegativeFinding : ExitCode::Done;
}

ExitCode reach(const WayArguments& arguments, Session& session) {
  const mapping::MapReader map = openMap(arguments, session);
  const Eigen::Vector2d from = tasks::placeNamed(map, arguments.from);
  const tasks::TerrainGrid terrain = terrainIn(map, arguments.request);
  const tasks::PassableGrid grid = passableIn(map, terrain, arguments.request);
  const double reach_m = arguments.minutes * 60 * arguments.speed_m_s;
  const LargeArray<double> walk_m = walkLengths(grid, from, reach_m);
  const auto cells = std::count_if(walk_m.begin(), walk_m.end(), [](double length) { return std::isfinite(length); });
  const double area_m2 = static_cast<double>(cells) * grid.frame.cell_m * grid.frame.cell_m;
  const auto reached = objectsWithin(terrain, walk_m, leftOut(map, arguments.request));
  if (session.json) {
    print(reachJson(map, reached, area_m2, arguments.speed_m_s));
    return ExitCode::Done;
  }
  std::printf("%.0f m2 within %.0f m\n", area_m2, reach_m);
  for (const tasks::ReachedObject& object : reached)
    std::printf("%7.1f m %6.0f s  %s\n", object.walk_m, object.walk_m / arguments.speed_m_s,
                tasks::thingName(map, object.object).c_str());
  return ExitCode::Done;
}

ExitCode costMap(const WayArguments& arguments, Session& session) {
  if (arguments.output.extension() != ".pgm")
    throw Error(ErrorKind::InvalidArgument, "costmap: the output is an image; write -o NAME.pgm");
  const fs::path yaml = fs::path(arguments.output).replace_extension(".yaml");
  refuseToReplaceMap(arguments.output);
  refuseToReplaceMap(yaml);
  const mapping::MapReader map = openMap(arguments, session);
  const tasks::CostMap cost_map =
      costMapOf(costMapGridIn(map, arguments.request), arguments.output.filename().string());
  writeOutput(yaml, cost_map.yaml);
  writeOutput(arguments.output, cost_map.image);
  return ExitCode::Done;
}

ExitCode search(const WayArguments& arguments, tasks::SearchRequest request, Session& session) {
  const mapping::MapReader map = openMap(arguments, session);
  request.ways = arguments.request;
  const tasks::SearchAnswer answer = searchFor(map, request);
  if (session.json) {
    print(searchJson(map, answer));
  } else {
    std::printf("%zu known\n", answer.known.size());
    for (std::size_t i = 0; i < answer.stops.size(); ++i) {
      const tasks::SearchStop& stop = answer.stops[i];
      const Eigen::Vector2d place = answer.frame.centreOf(stop.cell);
      const std::string reason =
          stop.reason == tasks::kAnywhere ? "not seen yet" : "near " + answer.reasons[stop.reason];
      std::printf("%2zu. (%.1f, %.1f)  walk %.1f m, in all %.1f m  %.1f %%, so far %.1f %%  %s\n", i + 1, place.x(),
                  place.y(), stop.walk_m, stop.total_m, stop.probability * 100, stop.so_far * 100, reason.c_str());
    }
  }
  return answer.stops.empty() ? ExitCode::NoRows : ExitCode::Done;
}

NumberRange numbersIn(const tasks::Limits& limits) {
  return {limits.min, limits.max};
}

WholeRange wholeNumbersIn(const tasks::Limits& limits) {
  return {static_cast<std::uint64_t>(limits.min), static_cast<std::uint64_t>(limits.max)};
}

/// Options of all ways.
void addWayOptions(CLI::App& command, WayArguments& arguments) {
  tasks::WayRequest& request = arguments.request;
  command.add_option("--without", request.without, "a class, Movable or Static: leave these objects out");
  command.add_flag("--with-gone", request.with_gone, "keep objects that later scans show to be gone");
  command.add_option("--max-slope", request.params.max_slope, "largest slope, rise over run [0.12]")
      ->check(within(numbersIn(tasks::kMaxSlope)));
  command.add_option("--max-step", request.params.max_step_m, "height of a kerb that can be crossed [m, 0.06]")
      ->check(within(numbersIn(tasks::kMaxStep_m)));
  command
      .add_option("--height", request.terrain.highest_m, "clearance: objects that hang higher are no obstacles [m, 2]")
      ->check(within(numbersIn(tasks::kClearance_m)));
  command.add_option("--cell", request.terrain.cell_m, "edge length of a grid cell [m, 0.25]")
      ->check(oneOf(std::vector<double>(tasks::kCells_m.begin(), tasks::kCells_m.end())));
  addAllowUnfinished(command, arguments.allow_unfinished);
}

void addWalkOptions(CLI::App& command, WayArguments& arguments) {
  command.add_option("map", arguments.map, "a map")->required();
  command.add_option("from", arguments.from, "X,Y in metres of the map frame, or an object")->required();
  command.add_option("--width", arguments.request.params.width_m, "free width that is needed [m, 0.6]")
      ->check(within(numbersIn(tasks::kWidth_m)));
}

ExitCode learnPlaces(const std::vector<fs::path>& maps, const fs::path& output, Session& session) {
  refuseToReplaceMap(output);
  tasks::PlaceLearner learner;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    session.console.progress("counting", i, maps.size());
    learner.add(mapping::MapReader(maps[i]));
  }
  session.console.progress("counting", maps.size(), maps.size());
  const std::vector<tasks::LearnedPlace> places = learner.learn();
  writeOutput(output, placesTurtle(places, learner.maps()));
  std::set<std::string> classes;
  for (const tasks::LearnedPlace& place : places) classes.insert(place.class_iri);
  if (session.json)
    printJson(Json{{"maps", maps.size()}, {"places", places.size()}, {"classes", classes.size()}});
  else
    std::printf("%s: %zu usual places of %zu classes; maps: %zu\n", output.c_str(), places.size(), classes.size(),
                maps.size());
  return ExitCode::Done;
}

CLI::App* addSearchLearn(CLI::App& search, Session& session) {
  auto maps = std::make_shared<std::vector<fs::path>>();
  auto output = std::make_shared<fs::path>();
  CLI::App* command =
      search.add_subcommand("learn", "learn the usual places of classes by counting in maps, for `search --places`");
  command->add_option("maps", *maps, "maps to count in")->required();
  command->add_option("-o,--output", *output, "the Turtle file to write")->required()->check(named());
  onRun(*command, session, [maps, output, &session] { return learnPlaces(*maps, *output, session); });
  return command;
}

void requireGiven(bool is_given, const char* name) {
  if (!is_given)
    throw Error(ErrorKind::InvalidArgument,
                std::string("search: ") + name + " is required; 'cluxel search --help' describes it");
}

void addSearch(CLI::App& app, Session& session) {
  auto options = std::make_shared<WayArguments>();
  auto request = std::make_shared<tasks::SearchRequest>();
  CLI::App* command = app.add_subcommand("search", "plan a walk that finds objects of a class soon");
  const CLI::App* learn = addSearchLearn(*command, session);
  command->add_option("map", options->map, "a map");
  command->add_option("--for", request->class_name, "the class to look for");
  command->add_option("--places", request->places,
                      "file of usual places that `search learn` wrote; default: those of the ontology");
  command->add_flag("--unobserved", options->request.params.crosses_unobserved,
                    "the walk may cross ground that was not observed");
  command->add_option("--from", request->from, "start: X,Y or an object; default: where the last scan was taken");
  command->add_option("--budget", request->tour.budget_m, "largest length of the walk [m]")
      ->check(above0())
      ->check(within(numbersIn(tasks::kBudget_m)));
  command->add_option("--stops", request->tour.max_stops, "largest number of stops [10]")
      ->check(wholeWithin(wholeNumbersIn(tasks::kTourStops)));
  command->add_option("--view", request->search.view_m, "distance within which an object is recognised [m, 10]")
      ->check(within(numbersIn(tasks::kView_m)));
  command
      ->add_option("--detection", request->search.detection,
                   "share of the objects of the class in view of a scan that the map holds [0.8]")
      ->check(within(numbersIn(tasks::kDetection)));
  command->add_option("--width", options->request.params.width_m, "free width that is needed [m, 0.6]")
      ->check(within(numbersIn(tasks::kWidth_m)));
  addWayOptions(*command, *options);
  onRun(*command, session, [options, request, learn, &session] {
    if (learn->parsed()) return session.exit_code;
    requireGiven(!options->map.empty(), "map");
    requireGiven(!request->class_name.empty(), "--for");
    return search(*options, *request, session);
  });
}

}  // namespace

void addWays(CLI::App& app, Session& session) {
  auto options = std::make_shared<WayArguments>();
  CLI::App* route_command = app.add_subcommand("route", "find routes over the ground, or say what blocks them");
  addWalkOptions(*route_command, *options);
  route_command->add_option("to", options->to, "X,Y in metres of the map frame, or an object")->required();
  addWayOptions(*route_command, *options);
  route_command->add_option("--near", options->request.near, "a class: prefer routes near objects of this class");
  route_command->add_option("--alternatives", options->alternatives, "number of routes to look for [1]")
      ->check(wholeWithin(wholeNumbersIn(tasks::kAlternatives)));
  route_command->add_option("--format", options->format, "geojson")->check(oneOf(std::vector<std::string>{"geojson"}));
  route_command->add_flag("--local", options->local,
                          "write GeoJSON in metres of the map frame instead of longitude and latitude");
  onRun(*route_command, session, [options, &session] { return route(*options, session); });

  auto reach_options = std::make_shared<WayArguments>();
  CLI::App* reach_command = app.add_subcommand("reach", "list the objects within a given time of walking");
  addWalkOptions(*reach_command, *reach_options);
  addWayOptions(*reach_command, *reach_options);
  reach_command->add_option("--minutes", reach_options->minutes, "largest duration of the walk [min, 5]")
      ->check(above0())
      ->check(within(numbersIn(tasks::kMinutes)));
  reach_command->add_option("--speed", reach_options->speed_m_s, "walking speed [m/s, 1.2]")
      ->check(within(numbersIn(tasks::kSpeed_m_s)));
  onRun(*reach_command, session, [reach_options, &session] { return reach(*reach_options, session); });

  auto map_options = std::make_shared<WayArguments>();
  CLI::App* map_command = app.add_subcommand("costmap", "write a cost map for ROS: NAME.pgm and NAME.yaml");
  map_command->add_option("map", map_options->map, "a map")->required();
  map_command->add_option("-o,--output", map_options->output, "the image to write, NAME.pgm")
      ->required()
      ->check(named());
  addWayOptions(*map_command, *map_options);
  onRun(*map_command, session, [map_options, &session] { return costMap(*map_options, session); });
  addSearch(app, session);
}

}  // namespace cluxel::app
