// SPDX-License-Identifier: Apache-2.0
// Routes and barriers from searches on the grid.
#include "tasks/ways/route.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/text/short_number.hpp"
#include "cluxel/error.hpp"
#include "tasks/ways/way_search.hpp"

namespace cluxel::tasks {

namespace {

constexpr double kSnap_m = 2.0;

std::string written(const Eigen::Vector2d& p_map) {
  return "(" + shortNumber(p_map.x(), 1) + ", " + shortNumber(p_map.y(), 1) + ")";
}

Route routeOf(const PassableGrid& grid, std::vector<std::uint32_t> cells) {
  Route route;
  route.narrowest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    route.steepest = std::max(route.steepest, static_cast<double>(grid.relief.slope[cells[i]]));
    route.narrowest_m = std::min(route.narrowest_m, 2 * static_cast<double>(grid.clearance_m[cells[i]]));
    if (i == 0) continue;
    const double length_m = (grid.frame.centreOf(cells[i]) - grid.frame.centreOf(cells[i - 1])).norm();
    const double rise_m = static_cast<double>(grid.height[cells[i]]) - static_cast<double>(grid.height[cells[i - 1]]);
    route.length_m += length_m;
    route.climb_m += std::max(0.0, rise_m);
    route.highest_step_m = std::max(route.highest_step_m, grid.stepBetween(cells[i - 1], cells[i]));
    route.cost +=
        length_m * (static_cast<double>(grid.factor[cells[i]]) + static_cast<double>(grid.factor[cells[i - 1]])) / 2;
  }
  route.cells = std::move(cells);
  return route;
}

/// Distances [m] from the cells of routes.
LargeArray<float> distancesFrom(const PassableGrid& grid, const std::vector<Route>& routes) {
  LargeArray<std::uint8_t> marked(grid.frame.size(), 0);
  for (const Route& route : routes)
    for (const std::uint32_t cell : route.cells) marked[cell] = 1;
  LargeArray<float> distance = nearestMarked(grid.frame, marked).distance;
  for (float& value : distance) value *= static_cast<float>(grid.frame.cell_m);
  return distance;
}

/// Another route, found where the known ones cost double; none when it is mostly one of them.
std::optional<Route> otherRoute(const PassableGrid& grid, std::uint32_t start, std::uint32_t goal,
                                const std::vector<Route>& known) {
  constexpr float beside_m = 2;
  constexpr double max_shared = 0.7;
  const LargeArray<float> distance = distancesFrom(grid, known);
  PassableGrid dearer = grid;
  for (std::size_t cell = 0; cell < distance.size(); ++cell)
    if (distance[cell] < beside_m) dearer.factor[cell] *= 2;
  std::vector<std::uint32_t> cells = wayTo(cheapestWays(dearer, start, {.goal = goal}), goal);
  const auto shared =
      std::count_if(cells.begin(), cells.end(), [&](std::uint32_t cell) { return distance[cell] < beside_m; });
  if (cells.empty() || static_cast<double>(shared) > max_shared * static_cast<double>(cells.size()))
    return std::nullopt;
  return routeOf(grid, std::move(cells));
}

std::optional<Barrier> barrierAt(const PassableGrid& grid, std::uint32_t before, std::uint32_t cell) {
  Barrier barrier;
  barrier.at = grid.frame.centreOf(cell);
  const Closure closure = grid.closure[cell];
  if (closure == Closure::Open) {
    if (grid.isStepOpen(before, cell)) return std::nullopt;
    barrier.kind = Barrier::Kind::Step;
    barrier.measured = grid.stepBetween(before, cell);
    return barrier;
  }
  if (closure == Closure::Unobserved) barrier.kind = Barrier::Kind::Unobserved;
  if (closure == Closure::TooSteep) barrier.kind = Barrier::Kind::TooSteep;
  if (closure == Closure::TooNarrow) barrier.kind = Barrier::Kind::TooNarrow;
  if (closure == Closure::Obstacle || closure == Closure::TooNarrow) barrier.thing = grid.blocker[cell];
  barrier.measured = closure == Closure::TooSteep    ? static_cast<double>(grid.relief.slope[cell])
                     : closure == Closure::TooNarrow ? 2 * static_cast<double>(grid.clearance_m[cell])
                                                     : 0.0;
  return barrier;
}

bool isSame(const Barrier& a, const Barrier& b) {
  return a.kind == b.kind && a.thing == b.thing;
}

std::vector<Barrier> barriersOn(const PassableGrid& grid, const std::vector<std::uint32_t>& cells) {
  std::vector<Barrier> barriers;
  bool goes_on = false;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    const auto barrier = barrierAt(grid, cells[i - 1], cells[i]);
    const bool is_new = barrier && !(goes_on && isSame(barriers.back(), *barrier));
    goes_on = barrier.has_value();
    if (!barrier) continue;
    if (is_new) barriers.push_back(*barrier);
    Barrier& last = barriers.back();
    last.length_m += (grid.frame.centreOf(cells[i]) - grid.frame.centreOf(cells[i - 1])).norm();
    last.measured = last.kind == Barrier::Kind::TooNarrow ? std::min(last.measured, barrier->measured)
                                                          : std::max(last.measured, barrier->measured);
  }
  return barriers;
}

}  // namespace

std::uint32_t openCellNear(const PassableGrid& grid, const Eigen::Vector2d& p_map) {
  const auto middle = grid.frame.cellAt(p_map);
  if (!middle) throw Error(ErrorKind::NotFound, "the place " + written(p_map) + " lies outside the map");
  const int reach = static_cast<int>(std::ceil(kSnap_m / grid.frame.cell_m));
  std::uint32_t best = *middle;
  double best_m = std::numeric_limits<double>::infinity();
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const int x = grid.frame.columnOf(*middle) + dx, y = grid.frame.rowOf(*middle) + dy;
      if (!grid.frame.holds(x, y) || grid.closure[grid.frame.index(x, y)] != Closure::Open) continue;
      const double distance_m = (grid.frame.centreOf(grid.frame.index(x, y)) - p_map).norm();
      if (distance_m >= best_m) continue;
      best_m = distance_m;
      best = grid.frame.index(x, y);
    }
  if (best_m <= kSnap_m) return best;
  throw Error(ErrorKind::NotFound, "no open ground lies within 2 m of " + written(p_map) +
                                       "; choose another place, or ask for less width or more slope");
}

RouteAnswer findRoutes(const PassableGrid& grid, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                       std::size_t count) {
  constexpr double closed_cost = 100;
  const std::uint32_t start = openCellNear(grid, from), goal = openCellNear(grid, to);
  RouteAnswer answer;
  std::vector<std::uint32_t> best = wayTo(cheapestWays(grid, start, {.goal = goal}), goal);
  if (best.empty()) {
    const SearchRules across{.closed_cost = closed_cost, .goal = goal};
    answer.barriers = barriersOn(grid, wayTo(cheapestWays(grid, start, across), goal));
    return answer;
  }
  answer.routes.push_back(routeOf(grid, std::move(best)));
  while (answer.routes.size() < count) {
    auto other = otherRoute(grid, start, goal, answer.routes);
    if (!other) break;
    answer.routes.push_back(std::move(*other));
  }
  std::stable_sort(answer.routes.begin(), answer.routes.end(),
                   [](const Route& a, const Route& b) { return a.cost < b.cost; });
  return answer;
}

LargeArray<double> walkLengths(const PassableGrid& grid, const Eigen::Vector2d& from, double reach_m) {
  LargeArray<double> length = cheapestWays(grid, openCellNear(grid, from), {.is_priced = false}).cost;
  for (double& value : length)
    if (value > reach_m) value = std::numeric_limits<double>::infinity();
  return length;
}

std::vector<ReachedObject> objectsWithin(const TerrainGrid& terrain, const LargeArray<double>& walk_m,
                                         const std::vector<bool>& is_left_out) {
  constexpr double beside_m = 1;
  const GridFrame& frame = terrain.frame;
  const int reach = static_cast<int>(std::ceil(beside_m / frame.cell_m));
  std::map<std::uint32_t, double> shortest;
  for (std::uint32_t cell = 0; cell < frame.size(); ++cell) {
    if (terrain.thingsIn(cell).empty()) continue;
    double best_m = std::numeric_limits<double>::infinity();
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx) {
        const int x = frame.columnOf(cell) + dx, y = frame.rowOf(cell) + dy;
        const bool is_beside = std::hypot(dx, dy) * frame.cell_m <= beside_m;
        if (is_beside && frame.holds(x, y)) best_m = std::min(best_m, walk_m[frame.index(x, y)]);
      }
    if (!std::isfinite(best_m)) continue;
    for (const std::uint32_t thing : terrain.thingsIn(cell)) {
      if (thing == kUnnamedThing || is_left_out[thing]) continue;
      const auto place = shortest.emplace(thing, best_m).first;
      place->second = std::min(place->second, best_m);
    }
  }
  std::vector<ReachedObject> reached;
  reached.reserve(shortest.size());
  for (const auto& [object, length_m] : shortest) reached.push_back({object, length_m});
  std::stable_sort(reached.begin(), reached.end(), [](const auto& a, const auto& b) { return a.walk_m < b.walk_m; });
  return reached;
}

}  // namespace cluxel::tasks
