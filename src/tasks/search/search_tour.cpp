// SPDX-License-Identifier: Apache-2.0
// Greedy choice of stops.
#include "tasks/search/search_tour.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "tasks/ways/way_search.hpp"

namespace cluxel::tasks {

namespace {

/// Candidates for stops with the probability in sight of each. Taking a view out never raises another one, so that the
/// last value that was computed bounds the present one.
class StopCandidates {
 public:
  StopCandidates(const SightGrid& sight, SearchField field, double view_m, std::vector<std::uint32_t> cells)
      : sight_(sight), field_(std::move(field)), view_m_(view_m), cells_(std::move(cells)) {
    bound_.assign(cells_.size(), 1.0);
  }

  /// The reachable stop with the highest probability per metre of walk; none when nothing more comes into sight.
  std::optional<SearchStop> best(const CheapestWays& ways, double total_m, const TourParams& params) {
    std::optional<SearchStop> best;
    double best_value = 0;
    for (const std::size_t i : leading(ways, total_m, params)) {
      const double walk = ways.cost[cells_[i]];
      const double probability = params.looks_on_way ? sumOver(inSightOnWay(ways, cells_[i])) : bound_[i];
      const double value = probability / (walk + params.settle_m);
      if (value <= best_value) continue;
      best_value = value;
      best = SearchStop{cells_[i], walk, total_m + walk, probability, 0, kAnywhere};
    }
    return best;
  }

  /// Removes what is seen from a stop, and on the way to it, from the field. Records the cells, and which places the
  /// probability came from.
  void take(SearchStop& stop, const CheapestWays& ways, const TourParams& params) {
    std::map<PlaceNumber, double> by_reason;
    stop.in_sight = params.looks_on_way ? inSightOnWay(ways, stop.cell) : visibleFrom(sight_, stop.cell, view_m_);
    for (const std::uint32_t cell : stop.in_sight) {
      by_reason[field_.reason[cell]] += field_.probability[cell];
      field_.probability[cell] = 0;
    }
    for (const auto& [reason, probability] : by_reason)
      if (probability > 0) stop.shares.emplace_back(reason, probability);
    std::stable_sort(stop.shares.begin(), stop.shares.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    if (!stop.shares.empty()) stop.reason = stop.shares.front().first;
  }

 private:
  static constexpr std::size_t kLeading = 16;

  /// The candidates with most in sight from the stop alone for each metre, best first, ties by number; one or kLeading.
  std::vector<std::size_t> leading(const CheapestWays& ways, double total_m, const TourParams& params) {
    const std::size_t wanted = params.looks_on_way ? kLeading : 1;
    const auto value = [&](std::size_t i) { return bound_[i] / (ways.cost[cells_[i]] + params.settle_m); };
    const auto isBetter = [&](std::size_t a, std::size_t b) {
      return std::pair(-value(a), a) < std::pair(-value(b), b);
    };
    std::vector<std::size_t> order, found;
    for (std::size_t i = 0; i < cells_.size(); ++i)
      if (std::isfinite(ways.cost[cells_[i]]) && bound_[i] > 0 &&
          (params.budget_m == 0 || total_m + ways.cost[cells_[i]] <= params.budget_m))
        order.push_back(i);
    std::sort(order.begin(), order.end(), isBetter);
    for (const std::size_t i : order) {
      if (found.size() == wanted && value(i) < value(found.back())) break;
      bound_[i] = sumOver(visibleFrom(sight_, cells_[i], view_m_));
      if (bound_[i] == 0) continue;
      found.insert(std::upper_bound(found.begin(), found.end(), i, isBetter), i);
      if (found.size() > wanted) found.pop_back();
    }
    return found;
  }

  /// The cells in sight from a stop and, every half view, from the way to it; ascending.
  std::vector<std::uint32_t> inSightOnWay(const CheapestWays& ways, std::uint32_t stop) const {
    std::vector<std::uint32_t> seen = visibleFrom(sight_, stop, view_m_);
    double looked_at_m = ways.cost[stop];
    for (std::uint32_t cell = stop; ways.before[cell] != cell; cell = ways.before[cell]) {
      if (looked_at_m - ways.cost[cell] < view_m_ / 2) continue;
      looked_at_m = ways.cost[cell];
      const std::vector<std::uint32_t> here = visibleFrom(sight_, cell, view_m_);
      seen.insert(seen.end(), here.begin(), here.end());
    }
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    return seen;
  }

  double sumOver(const std::vector<std::uint32_t>& cells) const {
    double sum = 0;
    for (const std::uint32_t cell : cells) sum += field_.probability[cell];
    return sum;
  }

  const SightGrid& sight_;
  SearchField field_;
  double view_m_;
  std::vector<std::uint32_t> cells_;
  std::vector<double> bound_;  ///< parallel to cells_
};

std::vector<std::uint32_t> candidatesOf(const PassableGrid& grid, std::uint32_t start, double view_m) {
  const int pitch = std::max(1, static_cast<int>(view_m / 2 / grid.frame.cell_m));
  std::vector<std::uint32_t> cells{start};
  for (int y = 0; y < grid.frame.rows; y += pitch)
    for (int x = 0; x < grid.frame.columns; x += pitch)
      if (grid.closure[grid.frame.index(x, y)] == Closure::Open) cells.push_back(grid.frame.index(x, y));
  return cells;
}

}  // namespace

std::vector<SearchStop> tourOf(const PassableGrid& grid, const SightGrid& sight, const SearchField& field,
                               const Eigen::Vector2d& from, const SearchParams& search, const TourParams& params) {
  std::uint32_t at = openCellNear(grid, from);
  StopCandidates candidates(sight, field, search.view_m, candidatesOf(grid, at, search.view_m));
  std::vector<SearchStop> stops;
  constexpr double kLeastShare = 0.01;  // of what the best stop showed: a walk for less is not worth it
  double total_m = 0, so_far = 0, largest = 0;
  while (stops.size() < params.max_stops) {
    const CheapestWays ways = cheapestWays(grid, at, {.is_priced = false});
    std::optional<SearchStop> best = candidates.best(ways, total_m, params);
    largest = std::max(largest, best ? best->probability : 0);
    if (!best || best->probability < kLeastShare * largest) break;
    candidates.take(*best, ways, params);
    best->way = wayTo(ways, best->cell);
    total_m = best->total_m;
    so_far += best->probability;
    best->so_far = so_far;
    at = best->cell;
    stops.push_back(std::move(*best));
  }
  return stops;
}

}  // namespace cluxel::tasks
