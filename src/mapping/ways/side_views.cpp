// SPDX-License-Identifier: Apache-2.0
// The direction of a line is the main axis of its cells nearby.
#include "mapping/ways/side_views.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "mapping/ways/ways.hpp"

namespace cluxel::mapping {

namespace {

/// Steps from a cell to cells that the line reaches within kSeenAlong steps, itself among them.
std::vector<CellPlace> cellsAlong(const TileCells& cells, const std::vector<std::uint8_t>& skeleton,
                                  std::uint32_t cell) {
  struct Reached {
    CellPlace offset;
    int steps;
  };
  std::vector<Reached> reached{{{0, 0}, 0}};
  constexpr int side = 2 * kSeenAlong + 1;
  std::array<bool, static_cast<std::size_t>(side) * side> is_seen{};
  const auto mark = [&](const CellPlace& at) {
    bool& seen = is_seen[static_cast<std::size_t>((at.y + kSeenAlong) * side + at.x + kSeenAlong)];
    return !std::exchange(seen, true);
  };
  mark({0, 0});
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const Reached from = reached[i];
    if (from.steps == kSeenAlong) break;
    for (const auto& [dx, dy] : kAroundCell) {
      const CellPlace to{from.offset.x + dx, from.offset.y + dy};
      const std::uint32_t near = cells.step(cell, static_cast<int>(to.x), static_cast<int>(to.y));
      if (near != kNoCell && skeleton[near] != 0 && mark(to)) reached.push_back({to, from.steps + 1});
    }
  }
  std::vector<CellPlace> offsets;
  for (const Reached& each : reached) offsets.push_back(each.offset);
  return offsets;
}

/// The unit vector across the main axis of some places.
Eigen::Vector2d acrossOf(const std::vector<CellPlace>& places) {
  std::int64_t n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (const CellPlace& p : places) ++n, x += p.x, y += p.y, xx += p.x * p.x, xy += p.x * p.y, yy += p.y * p.y;
  const auto difference = static_cast<double>(n * (xx - yy) - (x * x - y * y));
  const auto mixed = static_cast<double>(2 * (n * xy - x * y));
  const double length = std::sqrt(difference * difference + mixed * mixed);
  if (length == 0) return {0, 1};
  // The axis has half the angle of (difference, mixed).
  const double along_x = std::sqrt(0.5 * (1 + difference / length));
  const double along_y = std::copysign(std::sqrt(0.5 * (1 - difference / length)), mixed);
  return {-along_y, along_x};
}

struct SideView {
  std::uint8_t to_edge = 0;     // [kMarchStep_m]
  std::optional<float> rise_m;  // of the ground beyond the edge; absent where it was not measured
};

SideView sideFrom(const GroundCells& ground, std::uint32_t cell, const Eigen::Vector2d& across) {
  const auto cell_at = [&](double distance) {
    const Eigen::Vector2d offset = across * distance / kWayCell_m;
    return ground.cells.step(cell, static_cast<int>(std::floor(offset.x() + 0.5)),
                             static_cast<int>(std::floor(offset.y() + 0.5)));
  };
  SideView view;
  std::uint32_t last = cell;
  while (view.to_edge * kMarchStep_m < kFarthestSide_m) {
    const std::uint32_t at = cell_at(view.to_edge * kMarchStep_m);
    if (at == kNoCell || ground.even[at] == 0) break;
    last = at;
    ++view.to_edge;
  }
  constexpr double beyond_m = 0.5;
  const std::uint32_t beyond = cell_at(view.to_edge * kMarchStep_m + beyond_m);
  if (beyond != kNoCell && ground.measured[beyond] != 0) view.rise_m = ground.height[beyond] - ground.height[last];
  return view;
}

}  // namespace

AcrossWay acrossFrom(const GroundCells& ground, const std::vector<std::uint8_t>& skeleton, std::uint32_t cell) {
  const Eigen::Vector2d across = acrossOf(cellsAlong(ground.cells, skeleton, cell));
  const SideView left = sideFrom(ground, cell, across), right = sideFrom(ground, cell, -across);
  const auto is_kerb = [](const SideView& view, float sign) {
    return view.rise_m && *view.rise_m * sign >= kKerbSeen_m && *view.rise_m * sign <= kKerbHigh_m;
  };
  return {left.to_edge, right.to_edge, is_kerb(left, -1) || is_kerb(right, -1), is_kerb(left, 1) || is_kerb(right, 1)};
}

}  // namespace cluxel::mapping
