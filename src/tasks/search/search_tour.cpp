// SPDX-License-Identifier: Apache-2.0
// Greedy choice of stops.
#include "tasks/search/search_tour.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "tasks/ways/way_search.hpp"

namespace cluxel::tasks {

namespace {

/// The cells within view of a cell.
template <typename Visit>
void visitView(const GridFrame& frame, std::uint32_t cell, double view_m, const Visit& visit) {
  const int reach = static_cast<int>(std::floor(view_m / frame.cell_m));
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const int x = frame.columnOf(cell) + dx, y = frame.rowOf(cell) + dy;
      if (frame.holds(x, y) && std::hypot(dx, dy) * frame.cell_m <= view_m) visit(frame.index(x, y));
    }
}

double probabilityInView(const SearchField& field, std::uint32_t cell, double view_m) {
  double sum = 0;
  visitView(field.frame, cell, view_m, [&](std::uint32_t seen) { sum += field.probability[seen]; });
  return sum;
}

std::vector<std::uint32_t> candidatesOf(const PassableGrid& grid, std::uint32_t start, double view_m) {
  const int pitch = std::max(1, static_cast<int>(view_m / 2 / grid.frame.cell_m));
  std::vector<std::uint32_t> cells{start};
  for (int y = 0; y < grid.frame.rows; y += pitch)
    for (int x = 0; x < grid.frame.columns; x += pitch)
      if (grid.closure[grid.frame.index(x, y)] == Closure::Open) cells.push_back(grid.frame.index(x, y));
  return cells;
}

/// Takes what is seen from a stop out of the field; returns the place that most of it came from.
std::uint8_t takeView(SearchField& field, std::uint32_t cell, double view_m) {
  std::map<std::uint8_t, double> by_reason;
  visitView(field.frame, cell, view_m, [&](std::uint32_t seen) {
    by_reason[field.reason[seen]] += field.probability[seen];
    field.probability[seen] = 0;
  });
  const auto largest = std::max_element(by_reason.begin(), by_reason.end(),
                                        [](const auto& a, const auto& b) { return a.second < b.second; });
  return largest == by_reason.end() ? kAnywhere : largest->first;
}

}  // namespace

std::vector<SearchStop> tourOf(const PassableGrid& grid, const SearchField& field, const Eigen::Vector2d& from,
                               const SearchParams& search, const TourParams& params) {
  SearchField left = field;
  std::uint32_t at = openCellNear(grid, from);
  const std::vector<std::uint32_t> candidates = candidatesOf(grid, at, search.view_m);
  std::vector<SearchStop> stops;
  double total_m = 0, so_far = 0;
  while (stops.size() < params.max_stops) {
    const std::vector<double> walk_m = cheapestWays(grid, at, {.is_priced = false}).cost;
    SearchStop best;
    double best_value = 0;
    for (const std::uint32_t cell : candidates) {
      if (!std::isfinite(walk_m[cell]) || (params.budget_m > 0 && total_m + walk_m[cell] > params.budget_m)) continue;
      const double probability = probabilityInView(left, cell, search.view_m);
      const double value = probability / (walk_m[cell] + params.settle_m);
      if (probability < params.min_probability || value <= best_value) continue;
      best_value = value;
      best = {cell, walk_m[cell], total_m + walk_m[cell], probability, so_far + probability, kAnywhere};
    }
    if (best_value == 0) break;
    best.reason = takeView(left, best.cell, search.view_m);
    total_m = best.total_m;
    so_far = best.so_far;
    at = best.cell;
    stops.push_back(best);
  }
  return stops;
}

}  // namespace cluxel::tasks
