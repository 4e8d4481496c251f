// SPDX-License-Identifier: Apache-2.0
// Searches as values: numbers of objects become IRIs, and cells positions.
#include "api/task_values.hpp"
#include "api/way_values.hpp"
#include "cluxel/error.hpp"
#include "rdf/map_iris.hpp"
#include "tasks/search/search_tour.hpp"
#include "tasks/ways/way_limits.hpp"
#include "tasks/ways/way_report.hpp"

namespace cluxel {

namespace {

tasks::SearchRequest searchRequestOf(const std::string& class_name, const SearchOptions& options) {
  tasks::SearchRequest request;
  request.class_name = class_name;
  if (options.start) request.from = textOf(*options.start);
  request.places = options.places;
  request.ways = wayRequestOf(options.ground);
  request.ways.params.width_m = options.width_m;
  request.ways.params.crosses_unobserved = options.crosses_unobserved;
  request.search.view_m = options.view_m;
  request.search.detection = options.detection;
  request.tour.budget_m = options.budget_m.value_or(0);
  request.tour.max_stops = options.max_stops;
  tasks::requireValid(request);
  if (options.budget_m == 0.0)
    throw Error(ErrorKind::InvalidArgument, "budget of the walk [m]: write a number above 0, or none for no limit");
  if (options.start && request.from.empty())
    throw Error(ErrorKind::InvalidArgument, "the start of the search is an empty name; write X,Y or an object");
  return request;
}

SearchStop valueOf(const tasks::SearchAnswer& found, const tasks::SearchStop& stop) {
  SearchStop value;
  value.at = groundPositionOf(found.frame.centreOf(stop.cell));
  value.walk_m = stop.walk_m;
  value.total_m = stop.total_m;
  value.probability = stop.probability;
  value.so_far = stop.so_far;
  if (stop.reason != tasks::kAnywhere) value.near_class = found.reasons[stop.reason];
  value.way = lineOf(tasks::cornersOf(found.frame, stop.way));
  return value;
}

}  // namespace

SearchTour searchIn(const mapping::MapReader& map, const std::string& class_name, const SearchOptions& options) {
  const tasks::SearchAnswer found = tasks::searchFor(map, searchRequestOf(class_name, options));
  SearchTour tour;
  for (const tasks::KnownObject& known : found.known)
    tour.known.push_back({rdf::iriOfObject(map.objectIds()[known.object]), known.distance_m});
  for (const tasks::SearchStop& stop : found.stops) tour.stops.push_back(valueOf(found, stop));
  return tour;
}

}  // namespace cluxel
