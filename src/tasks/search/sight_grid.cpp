// SPDX-License-Identifier: Apache-2.0
// Rays over cells.
#include "tasks/search/sight_grid.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/facts/object_geometry.hpp"

namespace cluxel::tasks {

namespace {

/// Marks the cells that are visible from the middle of a cell, within a square around it.
class SightRays {
 public:
  SightRays(const SightGrid& sight, std::uint32_t cell, double view_m)
      : sight_(sight),
        x_(sight.frame.columnOf(cell)),
        y_(sight.frame.rowOf(cell)),
        reach_(static_cast<int>(std::floor(view_m / sight.frame.cell_m))),
        squared_(view_m * view_m / (sight.frame.cell_m * sight.frame.cell_m) + 1e-9),
        is_seen_(static_cast<std::size_t>(2 * reach_ + 1) * static_cast<std::size_t>(2 * reach_ + 1), 0) {}

  std::vector<std::uint32_t> cells() {
    mark(0, 0);
    for (int along = -reach_; along <= reach_; ++along)
      for (const auto& [dx, dy] :
           {std::pair(reach_, along), std::pair(-reach_, along), std::pair(along, reach_), std::pair(along, -reach_)})
        castRay(dx, dy);
    std::vector<std::uint32_t> found;
    for (int dy = -reach_; dy <= reach_; ++dy)
      for (int dx = -reach_; dx <= reach_; ++dx)
        if (is_seen_[slotOf(dx, dy)] != 0) found.push_back(sight_.frame.index(x_ + dx, y_ + dy));
    return found;
  }

 private:
  std::size_t slotOf(int dx, int dy) const {
    return static_cast<std::size_t>((dy + reach_) * (2 * reach_ + 1) + dx + reach_);
  }
  /// False when the ray ends here.
  bool mark(int dx, int dy) {
    if (!sight_.frame.holds(x_ + dx, y_ + dy) || dx * dx + dy * dy > squared_) return false;
    is_seen_[slotOf(dx, dy)] = 1;
    return (dx == 0 && dy == 0) || sight_.opaque[sight_.frame.index(x_ + dx, y_ + dy)] == 0;
  }
  void castRay(int dx, int dy) {
    for (int i = 1; i <= reach_; ++i) {
      const double share = static_cast<double>(i) / reach_;
      if (!mark(static_cast<int>(std::lround(dx * share)), static_cast<int>(std::lround(dy * share)))) return;
    }
  }

  const SightGrid& sight_;
  int x_, y_, reach_;
  double squared_;
  std::vector<std::uint8_t> is_seen_;
};

}  // namespace

SightGrid sightOf(const mapping::MapReader& map, const TerrainGrid& terrain, double eye_m) {
  std::vector<bool> is_high;
  for (const rules::SemanticObject& object : map.objects())
    is_high.push_back(mapping::geometryOf(map.scene().cluxels, mapping::cluxelsOf(object)).top_m >= eye_m);
  SightGrid sight{terrain.frame, std::vector<std::uint8_t>(terrain.frame.size(), 0)};
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell)
    for (const std::uint32_t thing : terrain.thingsIn(cell))
      if (thing != kUnnamedThing && is_high[thing]) sight.opaque[cell] = 1;
  return sight;
}

std::vector<std::uint32_t> visibleFrom(const SightGrid& sight, std::uint32_t cell, double view_m) {
  return SightRays(sight, cell, view_m).cells();
}

}  // namespace cluxel::tasks
