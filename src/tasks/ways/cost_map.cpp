// SPDX-License-Identifier: Apache-2.0
// Grey values of cells.
#include "tasks/ways/cost_map.hpp"

#include <array>
#include <cstdio>

namespace cluxel::tasks {

namespace {

constexpr char kFree = static_cast<char>(254), kOccupied = 0, kUnknown = static_cast<char>(205);

std::string quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

char greyOf(CellKind kind) {
  if (kind == CellKind::Unobserved) return kUnknown;
  return kind == CellKind::Free ? kFree : kOccupied;
}

}  // namespace

const char* nameOf(CellKind kind) {
  switch (kind) {
    case CellKind::Free:
      return "free";
    case CellKind::Thing:
      return "thing";
    case CellKind::Step:
      return "step";
    case CellKind::TooSteep:
      return "too steep";
    case CellKind::TooNarrow:
      return "too narrow";
    case CellKind::Unobserved:
      return "unobserved";
  }
  return "";
}

CellKind kindOf(const PassableGrid& grid, std::uint32_t cell) {
  switch (grid.closure[cell]) {
    case Closure::Open:
      return isBesideStep(grid, cell) ? CellKind::Step : CellKind::Free;
    case Closure::Obstacle:
      return CellKind::Thing;
    case Closure::TooSteep:
      return CellKind::TooSteep;
    case Closure::TooNarrow:
      return CellKind::TooNarrow;
    case Closure::Unobserved:
      break;
  }
  return CellKind::Unobserved;
}

PassableGrid costMapGridIn(const mapping::MapReader& map, WayRequest request) {
  request.params.width_m = 0;
  return passableIn(map, request);
}

bool isBesideStep(const PassableGrid& grid, std::uint32_t cell) {
  const int x = grid.frame.columnOf(cell), y = grid.frame.rowOf(cell);
  for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
    if (!grid.frame.holds(x + dx, y + dy)) continue;
    const std::uint32_t other = grid.frame.index(x + dx, y + dy);
    if (grid.closure[other] != Closure::Unobserved && !grid.isStepOpen(cell, other)) return true;
  }
  return false;
}

CostMap costMapOf(const PassableGrid& grid, const std::string& image_name) {
  const GridFrame& frame = grid.frame;
  CostMap map;
  map.image = "P5\n" + std::to_string(frame.columns) + " " + std::to_string(frame.rows) + "\n255\n";
  for (int row = frame.rows - 1; row >= 0; --row)
    for (int column = 0; column < frame.columns; ++column) map.image += greyOf(kindOf(grid, frame.index(column, row)));
  std::array<char, 256> text{};
  std::snprintf(
      text.data(), text.size(),
      "resolution: %g\norigin: [%.3f, %.3f, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\nmode: "
      "trinary\n",
      frame.cell_m, frame.min_x, frame.min_y);
  map.yaml = "image: " + quoted(image_name) + "\n" + text.data();
  return map;
}

}  // namespace cluxel::tasks
