// SPDX-License-Identifier: Apache-2.0
// Rays over cells.
#include "tasks/search/sight_grid.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/regions/tile_objects.hpp"

namespace cluxel::tasks {

namespace {

constexpr double kFarthestCell = 1e9;  ///< numbers of cells are int

/// Marks the cells that are visible from the middle of a cell, which may lie outside of the grid.
class SightRays {
 public:
  SightRays(const SightGrid& sight, int column, int row, double view_m)
      : sight_(sight), x_(column), y_(row), squared_(view_m * view_m / cellSquared() + 1e-9) {
    const GridFrame& frame = sight.frame;
    const int farthest =
        std::max({std::abs(x_), std::abs(frame.columns - 1 - x_), std::abs(y_), std::abs(frame.rows - 1 - y_)});
    reach_ = static_cast<int>(std::min<double>(farthest, std::floor(view_m / frame.cell_m)));
    low_x_ = std::max(0, x_ - reach_), low_y_ = std::max(0, y_ - reach_);
    width_ = std::max(0, std::min(frame.columns - 1, x_ + reach_) - low_x_ + 1);
    height_ = std::max(0, std::min(frame.rows - 1, y_ + reach_) - low_y_ + 1);
    is_seen_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
  }

  std::vector<std::uint32_t> cells() {
    if (is_seen_.empty()) return {};
    goesOn(0, 0);
    for (int along = -reach_; along <= reach_; ++along)
      for (const auto& [dx, dy] :
           {std::pair(reach_, along), std::pair(-reach_, along), std::pair(along, reach_), std::pair(along, -reach_)})
        castRay(dx, dy);
    std::vector<std::uint32_t> found;
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x)
        if (is_seen_[slotOf(low_x_ + x, low_y_ + y)] != 0) found.push_back(sight_.frame.index(low_x_ + x, low_y_ + y));
    return found;
  }

 private:
  double cellSquared() const { return sight_.frame.cell_m * sight_.frame.cell_m; }
  std::size_t slotOf(int x, int y) const {
    return static_cast<std::size_t>(y - low_y_) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x - low_x_);
  }
  /// Marks the cell, if it is one of the grid. False when the ray ends here.
  bool goesOn(int dx, int dy) {
    const double distance_squared = static_cast<double>(dx) * dx + static_cast<double>(dy) * dy;
    if (distance_squared > squared_) return false;
    if (!sight_.frame.holds(x_ + dx, y_ + dy)) return !sight_.frame.holds(x_, y_);  // it may still come to the grid
    is_seen_[slotOf(x_ + dx, y_ + dy)] = 1;
    return (dx == 0 && dy == 0) || sight_.opaque[sight_.frame.index(x_ + dx, y_ + dy)] == 0;
  }
  void castRay(int dx, int dy) {
    for (int i = 1; i <= reach_; ++i) {
      const double share = static_cast<double>(i) / reach_;
      if (!goesOn(static_cast<int>(std::lround(dx * share)), static_cast<int>(std::lround(dy * share)))) return;
    }
  }

  const SightGrid& sight_;
  int x_, y_;
  double squared_;
  int reach_ = 0;
  int low_x_ = 0, low_y_ = 0, width_ = 0, height_ = 0;  ///< the part of the grid that may be seen
  std::vector<std::uint8_t> is_seen_;
};

}  // namespace

SightGrid sightOf(const mapping::MapReader& map, const TerrainGrid& terrain, const std::vector<bool>& is_left_out,
                  double eye_m) {
  std::vector<bool> is_high;
  const std::vector<double> tops = mapping::topsOfObjects(map);
  for (std::size_t i = 0; i < tops.size(); ++i) is_high.push_back(!is_left_out[i] && tops[i] >= eye_m);
  SightGrid sight{terrain.frame, LargeArray<std::uint8_t>(terrain.frame.size(), 0)};
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell)
    for (const std::uint32_t thing : terrain.thingsIn(cell))
      if (thing != kUnnamedThing && is_high[thing]) sight.opaque[cell] = 1;
  return sight;
}

std::vector<std::uint32_t> visibleFrom(const SightGrid& sight, std::uint32_t cell, double view_m) {
  return SightRays(sight, sight.frame.columnOf(cell), sight.frame.rowOf(cell), view_m).cells();
}

std::vector<std::uint32_t> visibleFrom(const SightGrid& sight, const Eigen::Vector2d& p_map, double view_m) {
  const GridFrame& frame = sight.frame;
  const double column = std::floor((p_map.x() - frame.min_x) / frame.cell_m);
  const double row = std::floor((p_map.y() - frame.min_y) / frame.cell_m);
  const double reach = view_m / frame.cell_m + 1;
  const bool is_near = column >= -reach && row >= -reach && column < frame.columns + reach && row < frame.rows + reach;
  if (!is_near || std::max(std::abs(column), std::abs(row)) > kFarthestCell) return {};
  return SightRays(sight, static_cast<int>(column), static_cast<int>(row), view_m).cells();
}

}  // namespace cluxel::tasks
