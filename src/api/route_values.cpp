// SPDX-License-Identifier: Apache-2.0
// Routes and cost maps as values: numbers of objects become IRIs, and cells positions or kinds.
#include <cmath>

#include "api/task_values.hpp"
#include "api/way_values.hpp"
#include "rdf/map_iris.hpp"
#include "tasks/ways/cost_map.hpp"
#include "tasks/ways/way_limits.hpp"
#include "tasks/ways/way_report.hpp"

namespace cluxel {

namespace {

Route valueOf(const tasks::GridFrame& frame, const tasks::Route& found) {
  Route route;
  route.line = lineOf(tasks::cornersOf(frame, found.cells));
  route.length_m = found.length_m;
  route.cost = found.cost;
  route.climb_m = found.climb_m;
  route.steepest = found.steepest;
  route.highest_step_m = found.highest_step_m;
  if (std::isfinite(found.narrowest_m)) route.narrowest_m = found.narrowest_m;
  return route;
}

BarrierKind kindOf(tasks::Barrier::Kind kind) {
  switch (kind) {
    case tasks::Barrier::Kind::Unobserved:
      return BarrierKind::Unobserved;
    case tasks::Barrier::Kind::Obstacle:
      return BarrierKind::Thing;
    case tasks::Barrier::Kind::TooSteep:
      return BarrierKind::TooSteep;
    case tasks::Barrier::Kind::TooNarrow:
      return BarrierKind::TooNarrow;
    case tasks::Barrier::Kind::Step:
      break;
  }
  return BarrierKind::Step;
}

Barrier valueOf(const mapping::MapReader& map, const tasks::Barrier& found) {
  Barrier barrier;
  barrier.kind = kindOf(found.kind);
  if (found.thing != tasks::kUnnamedThing) barrier.object = rdf::iriOfObject(map.objectIds()[found.thing]);
  barrier.at = groundPositionOf(found.at);
  barrier.length_m = found.length_m;
  if (found.measured > 0) barrier.measured = found.measured;
  barrier.text = tasks::barrierText(map, found);
  return barrier;
}

GroundKind kindOf(tasks::CellKind kind) {
  switch (kind) {
    case tasks::CellKind::Free:
      return GroundKind::Free;
    case tasks::CellKind::Step:
      return GroundKind::Step;
    case tasks::CellKind::TooSteep:
      return GroundKind::TooSteep;
    case tasks::CellKind::Unobserved:
      return GroundKind::Unobserved;
    case tasks::CellKind::Thing:
    case tasks::CellKind::TooNarrow:  // not in a grid for a width of 0
      break;
  }
  return GroundKind::Thing;
}

}  // namespace

Routes routesIn(const mapping::MapReader& map, const Place& start, const Place& goal, const RouteOptions& options) {
  tasks::WayRequest request = wayRequestOf(options.ground);
  request.params.width_m = options.width_m;
  request.near = options.near;
  tasks::requireValid(request);
  tasks::requireWithin(tasks::kAlternatives, static_cast<double>(options.alternatives), "number of routes");
  const Eigen::Vector2d from = tasks::placeNamed(map, textOf(start)), to = tasks::placeNamed(map, textOf(goal));
  const tasks::PassableGrid grid = tasks::passableIn(map, request);
  const tasks::RouteAnswer found = tasks::findRoutes(grid, from, to, options.alternatives);
  Routes answer;
  for (const tasks::Route& route : found.routes) answer.routes.push_back(valueOf(grid.frame, route));
  for (const tasks::Barrier& barrier : found.barriers) answer.barriers.push_back(valueOf(map, barrier));
  return answer;
}

CostMap costMapIn(const mapping::MapReader& map, const GroundOptions& options) {
  const tasks::WayRequest request = wayRequestOf(options);
  tasks::requireValid(request);
  const tasks::PassableGrid grid = tasks::costMapGridIn(map, request);
  CostMap answer;
  answer.min_x = grid.frame.min_x;
  answer.min_y = grid.frame.min_y;
  answer.cell_m = grid.frame.cell_m;
  answer.columns = static_cast<std::size_t>(grid.frame.columns);
  answer.rows = static_cast<std::size_t>(grid.frame.rows);
  answer.cells.reserve(grid.frame.size());
  for (std::uint32_t cell = 0; cell < grid.frame.size(); ++cell)
    answer.cells.push_back(kindOf(tasks::kindOf(grid, cell)));
  return answer;
}

}  // namespace cluxel
