// SPDX-License-Identifier: Apache-2.0
// Walks over a campus.
#include "search_walks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "rdf/ontology/ontology.hpp"
#include "tasks/gone_things.hpp"
#include "tasks/ways/way_search.hpp"

namespace cluxel::bench {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kLookEvery_m = 1;
constexpr double kLongest_m = 20'000;  ///< a walk that finds nothing ends

}  // namespace

Walker::Walker(const SearchWorld& world, bool knows_ground)
    : world_(world),
      belief_(world.belief()),
      sight_(sightOf(world.map(), world.terrain(), tasks::goneAmong(world.map()), world.params().eye_m)) {
  nearest_.assign(world.frame().size(), std::numeric_limits<float>::infinity());
  is_found_.assign(world.targets().size(), false);
  wanted_ = static_cast<std::size_t>(std::ceil(0.8 * static_cast<double>(world.targets().size()) - 1e-9));
  tasks::PassableGrid truth = belief_;
  truth.closure = world.closure();
  if (knows_ground) belief_ = truth;
  at_ = openCellNear(truth, world.start());
  look();
}

void Walker::look() {
  const tasks::GridFrame& frame = world_.frame();
  const Eigen::Vector2d here = frame.centreOf(at_);
  for (const std::uint32_t cell : visibleFrom(world_.sight(), at_, world_.params().view_m)) {
    belief_.closure[cell] = world_.closure()[cell];
    sight_.opaque[cell] = world_.sight().opaque[cell];
    seen_.push_back(cell);
    nearest_[cell] = std::min(nearest_[cell], static_cast<float>((frame.centreOf(cell) - here).norm()));
  }
  for (std::size_t i = 0; i < is_found_.size(); ++i)
    if (!is_found_[i] && world_.isSeenFrom(world_.targets()[i], at_)) {
      is_found_[i] = true;
      ++found_;
    }
  looked_at_m_ = length_m_;
}

bool Walker::doubtMap() {
  bool any = std::isfinite(belief_.max_step_m);  // heights of the map, too
  belief_.max_step_m = kInfinite;
  for (std::uint32_t cell = 0; cell < nearest_.size(); ++cell) {
    if (!world_.isInSite(cell)) continue;
    const tasks::Closure now = std::isinf(nearest_[cell]) ? tasks::Closure::Open : world_.closure()[cell];
    any = any || (belief_.closure[cell] != tasks::Closure::Open && now == tasks::Closure::Open);
    belief_.closure[cell] = now;
  }
  return any;
}

std::vector<std::uint32_t> Walker::takeSeen() {
  std::sort(seen_.begin(), seen_.end());
  seen_.erase(std::unique(seen_.begin(), seen_.end()), seen_.end());
  return std::exchange(seen_, {});
}

/// Learns whether the next cell is closed, or on a diagonal step a cell beside it: such a step has no way back.
bool Walker::isBlocked(std::uint32_t next) {
  const auto columns = static_cast<std::uint32_t>(world_.frame().columns);
  const std::uint32_t beside_x = at_ / columns * columns + next % columns,
                      beside_y = next / columns * columns + at_ % columns;
  bool is_blocked = false;
  for (const std::uint32_t cell : {next, beside_x, beside_y}) {
    if (cell == at_ || world_.closure()[cell] == tasks::Closure::Open) continue;
    is_blocked = true;
    belief_.closure[cell] = tasks::Closure::Obstacle;
  }
  return is_blocked;
}

template <typename Enough>
bool Walker::walkTo(std::uint32_t goal, const Enough& isEnough, const tasks::CheapestWays* ways) {
  while (at_ != goal && !isDone()) {
    const auto way = ways != nullptr ? wayTo(*ways, goal)
                                     : wayTo(cheapestWays(belief_, at_, {.is_priced = false, .goal = goal}), goal);
    ways = nullptr;
    if (way.empty()) return false;
    for (std::size_t i = 1; i < way.size(); ++i) {
      if (isBlocked(way[i])) break;  // seen when one stands before it
      length_m_ += (world_.frame().centreOf(way[i]) - world_.frame().centreOf(at_)).norm();
      at_ = way[i];
      if (length_m_ - looked_at_m_ < kLookEvery_m && i + 1 < way.size()) continue;
      look();
      if (isDone() || isEnough() || length_m_ > kLongest_m) return true;
      if (std::any_of(way.begin() + static_cast<std::ptrdiff_t>(i), way.end(),
                      [&](std::uint32_t cell) { return belief_.closure[cell] != tasks::Closure::Open; }))
        break;
    }
    if (belief_.closure[goal] != tasks::Closure::Open) return false;
  }
  return true;
}

namespace {

/// Goes on to the nearest ground that was not looked at.
double sweepLength(Walker& walker, bool spares_known) {
  const SearchWorld& world = walker.world();
  const std::size_t size = world.frame().size();
  std::vector<std::uint8_t> is_later(size, 0);
  if (spares_known) {
    tasks::SearchParams search;
    search.view_m = world.params().view_m;
    search.fade = 1;
    const auto known = knownShare(world.map(), world.terrain(), walker.sight(), search);
    for (std::uint32_t cell = 0; cell < size; ++cell) is_later[cell] = known[cell] > 0 ? 1 : 0;
  }
  double near_m = world.params().view_m;
  std::vector<std::uint8_t> given_up(size, 0);
  while (!walker.isDone() && walker.length_m() < kLongest_m && near_m > world.params().cell_m) {
    const tasks::CheapestWays ways = cheapestWays(walker.belief(), walker.at(), {.is_priced = false});
    const auto& walk_m = ways.cost;
    std::uint32_t goal = 0;
    double best = kInfinite;
    for (std::uint32_t cell = 0; cell < size; ++cell)
      if (walk_m[cell] < best && walker.nearest()[cell] > near_m && is_later[cell] == 0 && given_up[cell] == 0) {
        best = walk_m[cell];
        goal = cell;
      }
    if (best == kInfinite) {  // all was looked at: what was spared, then nearer
      const bool has_spared = std::count(is_later.begin(), is_later.end(), 1) > 0;
      std::fill(is_later.begin(), is_later.end(), std::uint8_t{0});
      if (!has_spared && !walker.doubtMap()) near_m /= 2;
      continue;
    }
    if (!walker.walkTo(
            goal, [&] { return walker.nearest()[goal] <= near_m; }, &ways))
      given_up[goal] = 1;
  }
  return walker.isDone() ? walker.length_m() : kInfinite;
}

}  // namespace

/// When nothing likely is left, the walk goes on to the nearest ground that was not looked at.
double searchLength(const SearchWorld& world, const std::vector<rdf::UsualPlace>& places) {
  constexpr double missed = 0.1;         // a place that was looked at may still hide something
  constexpr double nothing_left = 1e-3;  // of the probability of the whole site, at the best stop
  const tasks::TerrainGrid terrain = world.terrain();
  Walker walker(world);
  tasks::SearchParams search;
  search.view_m = world.params().view_m;
  search.eye_m = world.params().eye_m;
  tasks::SearchField field = fieldOf(world.frame(), knownShare(world.map(), terrain, walker.sight(), search),
                                     evidenceOf(world.map(), terrain, places, tasks::goneAmong(world.map())));
  tasks::TourParams tour;
  tour.max_stops = 1;
  while (!walker.isDone()) {
    for (const std::uint32_t cell : walker.takeSeen()) field.probability[cell] *= missed;
    const auto stops =
        tourOf(walker.belief(), walker.sight(), field, world.frame().centreOf(walker.at()), search, tour);
    if (stops.empty() && walker.doubtMap()) continue;  // the map encloses the walker
    if (stops.empty() || stops[0].probability < nothing_left) return sweepLength(walker, false);
    const std::uint32_t goal = stops[0].cell;
    if (goal == walker.at()) walker.look();
    if (!walker.walkTo(goal, [] { return false; }))  // no way leads there
      for (const std::uint32_t cell : visibleFrom(walker.sight(), goal, search.view_m))
        field.probability[cell] *= missed;
  }
  return walker.length_m();
}

double frontierLength(const SearchWorld& world, bool spares_known) {
  Walker walker(world);
  return sweepLength(walker, spares_known);
}

double lanesLength(const SearchWorld& world) {
  Walker walker(world);
  const tasks::GridFrame& frame = world.frame();
  double apart_m = 1.8 * world.params().view_m;
  for (int round = 0; round < 4 && !walker.isDone(); ++round, apart_m /= 2) {
    if (round > 0) walker.doubtMap();
    const int pitch = std::max(1, static_cast<int>(apart_m / frame.cell_m)), step = static_cast<int>(5 / frame.cell_m);
    bool is_backwards = false;
    for (int row = pitch / 2; row < frame.rows && !walker.isDone(); row += pitch, is_backwards = !is_backwards)
      for (int i = 0; i < frame.columns && !walker.isDone(); i += step) {
        const std::uint32_t goal = frame.index(is_backwards ? frame.columns - 1 - i : i, row);
        if (walker.belief().closure[goal] == tasks::Closure::Open)
          walker.walkTo(goal, [&] { return walker.belief().closure[goal] != tasks::Closure::Open; });
      }
  }
  return walker.isDone() ? walker.length_m() : kInfinite;
}

namespace {

/// The shortest order in which `wanted` targets are visited, by dynamic programming over sets of targets.
std::vector<std::size_t> shortestOrder(const std::vector<std::vector<double>>& way_m, std::size_t wanted) {
  const std::size_t n = way_m.size() - 1;  // the last row is the start
  const std::size_t sets = std::size_t{1} << n;
  std::vector<std::vector<double>> cost(sets, std::vector<double>(n, kInfinite));
  std::vector<std::vector<std::size_t>> before(sets, std::vector<std::size_t>(n, n));
  for (std::size_t i = 0; i < n; ++i) cost[std::size_t{1} << i][i] = way_m[n][i];
  std::size_t best_set = 0, best_last = 0;
  double best = kInfinite;
  for (std::size_t set = 1; set < sets; ++set)
    for (std::size_t last = 0; last < n; ++last) {
      if (!std::isfinite(cost[set][last])) continue;
      if (static_cast<std::size_t>(__builtin_popcountll(set)) == wanted && cost[set][last] < best) {
        best = cost[set][last];
        best_set = set;
        best_last = last;
      }
      for (std::size_t next = 0; next < n; ++next) {
        const std::size_t grown = set | (std::size_t{1} << next);
        if (grown == set || cost[set][last] + way_m[last][next] >= cost[grown][next]) continue;
        cost[grown][next] = cost[set][last] + way_m[last][next];
        before[grown][next] = last;
      }
    }
  std::vector<std::size_t> order;
  for (std::size_t at = best_last, set = best_set; at < n && set != 0;) {
    order.push_back(at);
    const std::size_t previous = before[set][at];
    set &= ~(std::size_t{1} << at);
    at = previous;
  }
  std::reverse(order.begin(), order.end());
  return order;
}

}  // namespace

double knowingLength(const SearchWorld& world) {
  constexpr std::size_t most_exact = 12;
  Walker walker(world, true);
  const tasks::PassableGrid& truth = walker.belief();
  const std::size_t n = world.targets().size();
  std::vector<std::uint32_t> cells;  // from which each is seen, the nearest to it
  for (const SearchTarget& target : world.targets()) {
    std::uint32_t best = walker.at();
    double nearest = kInfinite;
    for (std::uint32_t cell = 0; cell < world.frame().size(); ++cell) {
      const double distance = (world.frame().centreOf(cell) - target.at).norm();
      if (distance < nearest && truth.closure[cell] == tasks::Closure::Open && world.isSeenFrom(target, cell)) {
        nearest = distance;
        best = cell;
      }
    }
    cells.push_back(best);
  }
  cells.push_back(walker.at());
  std::vector<std::vector<double>> way_m;
  for (const std::uint32_t from : cells) {
    const auto cost = cheapestWays(truth, from, {.is_priced = false}).cost;
    way_m.emplace_back();
    for (std::size_t i = 0; i < n; ++i) way_m.back().push_back(cost[cells[i]]);
  }
  std::vector<std::size_t> order;
  const auto wanted = static_cast<std::size_t>(std::ceil(0.8 * static_cast<double>(n) - 1e-9));
  if (n <= most_exact) order = shortestOrder(way_m, wanted);
  std::vector<bool> is_left(n, true);
  for (std::size_t at = n; n > most_exact && order.size() < n;) {
    std::size_t next = n;
    for (std::size_t i = 0; i < n; ++i)
      if (is_left[i] && (next == n || way_m[at][i] < way_m[at][next])) next = i;
    is_left[next] = false;
    order.push_back(next);
    at = next;
  }
  for (const std::size_t i : order)
    if (!walker.isFound(i) && !walker.isDone()) walker.walkTo(cells[i], [&] { return walker.isFound(i); });
  return walker.isDone() ? walker.length_m() : kInfinite;
}

}  // namespace cluxel::bench
