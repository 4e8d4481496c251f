// SPDX-License-Identifier: Apache-2.0
// Finds kerbs as steps of the ground, and measures the free ground above them.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "tasks/inventory/inventory.hpp"

namespace cluxel::tasks {

namespace {

/// A cell on the low side of a kerb: where the ground steps up, and how far it is free there.
struct KerbCell {
  Eigen::Vector2d at;
  double width_m = 0;
};

class KerbFinder {
 public:
  KerbFinder(const TerrainGrid& terrain, const KerbParams& params) : terrain_(terrain), params_(params) {}

  std::vector<KerbCell> cells() const {
    std::vector<KerbCell> found;
    for (std::uint32_t cell = 0; cell < terrain_.frame.size(); ++cell)
      if (const auto kerb = kerbAt(cell)) found.push_back(*kerb);
    return found;
  }

 private:
  static constexpr std::array<std::array<int, 2>, 8> kDirections{
      {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

  std::optional<std::uint32_t> groundCell(int x, int y) const {
    if (!terrain_.frame.holds(x, y)) return std::nullopt;
    const std::uint32_t cell = terrain_.frame.index(x, y);
    return terrain_.seen[cell] != 0 ? std::optional(cell) : std::nullopt;
  }
  double heightOf(std::uint32_t cell) const { return static_cast<double>(terrain_.height[cell]); }

  /// The ground is level before and behind the step: a slope or a bush is no kerb.
  std::optional<KerbCell> kerbAt(std::uint32_t cell) const {
    constexpr double level_m = 0.04;
    const int x = terrain_.frame.columnOf(cell), y = terrain_.frame.rowOf(cell);
    std::optional<KerbCell> best;
    double highest = params_.least_step_m;
    for (const auto& [dx, dy] : kDirections) {
      const auto before = groundCell(x - dx, y - dy), up = groundCell(x + dx, y + dy),
                 behind = groundCell(x + 2 * dx, y + 2 * dy);
      if (terrain_.seen[cell] == 0 || !before || !up || !behind) continue;
      const double step = heightOf(*behind) - heightOf(cell);
      const bool is_level = std::abs(heightOf(cell) - heightOf(*before)) < level_m &&
                            std::abs(heightOf(*behind) - heightOf(*up)) < level_m;
      if (!is_level || step < highest || step > params_.highest_step_m) continue;
      const auto width = freeWidth(x + dx, y + dy, dx, dy);
      if (!width) continue;
      highest = step;
      best = KerbCell{terrain_.frame.centreOf(*up), *width};
    }
    return best;
  }

  /// From the kerb's upper edge to the first thing; poles that stand beside the kerb are passed.
  std::optional<double> freeWidth(int x, int y, int dx, int dy) const {
    constexpr double beside_kerb_m = 0.8;
    const double pitch_m = terrain_.frame.cell_m * std::hypot(dx, dy);
    double width_m = pitch_m / 2;
    for (int i = 1; width_m < params_.widest_m; ++i) {
      const auto cell = groundCell(x + i * dx, y + i * dy);
      if (!cell) return std::nullopt;  // not observed to its end
      if (!terrain_.thingsIn(*cell).empty() && width_m > beside_kerb_m) break;
      width_m += pitch_m;
    }
    return std::min(width_m, params_.widest_m);
  }

  const TerrainGrid& terrain_;
  const KerbParams& params_;
};

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

InventoryItem stretchOf(const std::vector<KerbCell>& cells) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  std::vector<double> widths;
  for (const KerbCell& cell : cells) {
    middle += cell.at / static_cast<double>(cells.size());
    widths.push_back(cell.width_m);
  }
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const KerbCell& cell : cells) spread += (cell.at - middle) * (cell.at - middle).transpose();
  const double angle = 0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1));
  const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
  double low = 0, high = 0;
  for (const KerbCell& cell : cells) {
    low = std::min(low, (cell.at - middle).dot(along));
    high = std::max(high, (cell.at - middle).dot(along));
  }
  InventoryItem item;
  item.kind = "Sidewalk";
  item.at = middle;
  item.width_m = medianOf(std::move(widths));
  item.length_m = high - low;
  item.line = {middle + low * along, middle + high * along};
  return item;
}

}  // namespace

std::vector<InventoryItem> sidewalksOf(const TerrainGrid& terrain, const KerbParams& params) {
  std::map<std::pair<int, int>, std::vector<KerbCell>> stretches;
  for (const KerbCell& cell : KerbFinder(terrain, params).cells())
    stretches[{static_cast<int>(std::floor(cell.at.x() / params.stretch_m)),
               static_cast<int>(std::floor(cell.at.y() / params.stretch_m))}]
        .push_back(cell);
  std::vector<InventoryItem> items;
  for (const auto& [block, cells] : stretches)
    if (cells.size() >= params.least_cells) items.push_back(stretchOf(cells));
  return items;
}

}  // namespace cluxel::tasks
