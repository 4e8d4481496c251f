// SPDX-License-Identifier: Apache-2.0
// Slopes, steps, clearances and costs of cells.
#include "tasks/ways/passable_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cluxel::tasks {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// The lower envelope of parabolas over one line: distances squared, and the place that gives each.
void lineDistances(const std::vector<double>& in, std::vector<double>& out, std::vector<int>& from) {
  const int n = static_cast<int>(in.size());
  std::vector<int> vertex(in.size());
  std::vector<double> bound(in.size() + 1);
  int last = -1;
  for (int q = 0; q < n; ++q) {
    if (in[q] == kInfinite) continue;
    double meet = -kInfinite;
    while (last >= 0) {
      const int v = vertex[last];
      meet = ((in[q] + static_cast<double>(q) * q) - (in[v] + static_cast<double>(v) * v)) / (2.0 * (q - v));
      if (meet > bound[last]) break;
      --last;
    }
    if (last < 0) meet = -kInfinite;
    vertex[++last] = q;
    bound[last] = meet;
    bound[last + 1] = kInfinite;
  }
  int at = 0;
  for (int q = 0; q < n; ++q) {
    if (last < 0) {
      out[q] = kInfinite;
      from[q] = q;
      continue;
    }
    while (bound[at + 1] < q) ++at;
    const double d = q - vertex[at];
    out[q] = d * d + in[vertex[at]];
    from[q] = vertex[at];
  }
}

/// The first thing of a cell that is not left out; absent when the cell is free.
std::optional<std::uint32_t> thingLeft(const TerrainGrid& terrain, std::uint32_t cell,
                                       const std::vector<bool>& is_left_out) {
  for (const std::uint32_t thing : terrain.thingsIn(cell))
    if (thing == kUnnamedThing || !is_left_out[thing]) return thing;
  return std::nullopt;
}

void closeCells(const TerrainGrid& terrain, const WayParams& params, const std::vector<bool>& is_left_out,
                PassableGrid& grid) {
  const std::size_t size = grid.frame.size();
  LargeArray<std::uint8_t> is_thing(size, 0);
  for (std::uint32_t cell = 0; cell < size; ++cell) {
    const auto thing = thingLeft(terrain, cell, is_left_out);
    is_thing[cell] = thing.has_value() ? 1 : 0;
    if (thing) grid.blocker[cell] = *thing;
  }
  const NearestMarked nearest = nearestMarked(grid.frame, is_thing);
  for (std::uint32_t cell = 0; cell < size; ++cell) {
    grid.clearance_m[cell] = static_cast<float>(nearest.distance[cell] * grid.frame.cell_m);
    if (is_thing[cell] != 0) {
      grid.closure[cell] = Closure::Obstacle;
    } else if (terrain.seen[cell] == 0 && !params.crosses_unobserved) {
      grid.closure[cell] = Closure::Unobserved;
    } else if (grid.relief.slope[cell] > params.max_slope) {
      grid.closure[cell] = Closure::TooSteep;
    } else if (grid.clearance_m[cell] < params.width_m / 2) {
      grid.closure[cell] = Closure::TooNarrow;
      grid.blocker[cell] = grid.blocker[nearest.cell[cell]];
    }
  }
}

/// A metre costs more on slopes, beside things, and far from what the way should stay near.
void priceCells(const TerrainGrid& terrain, const WayParams& params, const LargeArray<std::uint8_t>& near,
                PassableGrid& grid) {
  constexpr double slope_weight = 5, crowded_weight = 0.5, roomy_m = 1;
  const NearestMarked nearest = near.empty() ? NearestMarked{} : nearestMarked(grid.frame, near);
  for (std::uint32_t cell = 0; cell < grid.frame.size(); ++cell) {
    double factor = 1 + slope_weight * grid.relief.slope[cell];
    factor += crowded_weight * std::max(0.0, 1 - static_cast<double>(grid.clearance_m[cell]) / roomy_m);
    if (terrain.seen[cell] == 0) factor *= params.unobserved_factor;
    const bool is_far = !near.empty() && nearest.distance[cell] * grid.frame.cell_m > params.near_m;
    grid.factor[cell] = static_cast<float>(is_far ? factor * params.far_factor : factor);
  }
}

}  // namespace

NearestMarked nearestMarked(const GridFrame& frame, const LargeArray<std::uint8_t>& marked) {
  constexpr std::uint32_t no_row = 0xffffffffU;
  std::vector<double> line, out;
  std::vector<int> from;
  const auto resize = [&](int n) {
    line.resize(static_cast<std::size_t>(n));
    out.resize(line.size());
    from.resize(line.size());
  };
  NearestMarked nearest{LargeArray<float>(frame.size()), LargeArray<std::uint32_t>(frame.size())};
  resize(frame.rows);
  for (int x = 0; x < frame.columns; ++x) {  // nearest.cell holds the row of the nearest mark of the column
    for (int y = 0; y < frame.rows; ++y) line[y] = marked[frame.index(x, y)] != 0 ? 0 : kInfinite;
    lineDistances(line, out, from);
    for (int y = 0; y < frame.rows; ++y)
      nearest.cell[frame.index(x, y)] = out[y] == kInfinite ? no_row : static_cast<std::uint32_t>(from[y]);
  }
  resize(frame.columns);
  std::vector<std::uint32_t> row_of(line.size());
  for (int y = 0; y < frame.rows; ++y) {
    for (int x = 0; x < frame.columns; ++x) {
      row_of[x] = nearest.cell[frame.index(x, y)];
      const double rows = static_cast<double>(y) - row_of[x];
      line[x] = row_of[x] == no_row ? kInfinite : rows * rows;
    }
    lineDistances(line, out, from);
    for (int x = 0; x < frame.columns; ++x) {
      const std::uint32_t cell = frame.index(x, y);
      nearest.distance[cell] = static_cast<float>(std::sqrt(out[x]));
      nearest.cell[cell] = out[x] == kInfinite ? cell : frame.index(from[x], static_cast<int>(row_of[from[x]]));
    }
  }
  return nearest;
}

double PassableGrid::stepBetween(std::uint32_t a, std::uint32_t b) const {
  const int x = std::min(frame.columnOf(a), frame.columnOf(b)), y = std::min(frame.rowOf(a), frame.rowOf(b));
  const bool is_beside = frame.columnOf(a) != frame.columnOf(b), is_above = frame.rowOf(a) != frame.rowOf(b);
  const std::uint32_t corner = frame.index(x, y);
  float step = 0;
  if (is_beside) step = relief.step_east[corner];
  if (is_above) step = std::max(step, relief.step_north[corner]);
  if (is_beside && is_above)  // over either of the two cells beside
    step = std::max({step, relief.step_east[frame.index(x, y + 1)], relief.step_north[frame.index(x + 1, y)]});
  return static_cast<double>(step);
}

PassableGrid passableOf(const TerrainGrid& terrain, const WayParams& params, const std::vector<bool>& is_left_out,
                        const LargeArray<std::uint8_t>& near) {
  const std::size_t size = terrain.frame.size();
  PassableGrid grid;
  grid.frame = terrain.frame;
  grid.closure.assign(size, Closure::Open);
  grid.blocker.assign(size, kUnnamedThing);
  grid.factor.assign(size, 1.0F);
  grid.clearance_m.assign(size, 0.0F);
  grid.height = terrain.height;
  grid.relief = reliefOf(terrain);
  grid.max_step_m = params.max_step_m;
  closeCells(terrain, params, is_left_out, grid);
  priceCells(terrain, params, near, grid);
  return grid;
}

}  // namespace cluxel::tasks
