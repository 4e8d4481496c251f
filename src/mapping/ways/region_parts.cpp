// SPDX-License-Identifier: Apache-2.0
// Parts grow from their first cells; parts that end within their tile and are too small for a region are dropped.
#include "mapping/ways/region_parts.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/ways/ways.hpp"

namespace cluxel::mapping {

namespace {

/// Where a cell's neighbour in another tile lies, as in ringOf(); `x` and `y` are the neighbour's column and row.
std::uint8_t ringAt(int x, int y) {
  const auto beyond = [](int at) { return at < 0 ? 0 : at < kCellsPerTile ? 1 : 2; };
  return static_cast<std::uint8_t>(beyond(y) * 3 + beyond(x));
}

bool isOnBorder(std::uint32_t cell) {
  const std::uint32_t x = cell % kCellsPerTile, y = cell % kCellsOfTile / kCellsPerTile;
  return x == 0 || y == 0 || x == kCellsPerTile - 1 || y == kCellsPerTile - 1;
}

}  // namespace

RegionParts::RegionParts(const GroundCells& ground)
    : ground_(ground),
      is_open_(ground.cells.size()),
      part_at_(ground.cells.size(), kNoRegion),
      parts_(ground.cells.keys().size()) {
  for (std::uint32_t cell = 0; cell < ground.cells.size(); ++cell)
    is_open_[cell] = (ground.measured[cell] != 0 || ground.even[cell] != 0) && ground.thing[cell] == 0 ? 1 : 0;
  for (std::uint32_t slot = 0; slot < parts_.size(); ++slot) findParts(slot);
}

/// Both are open.
bool RegionParts::isCrossed(std::uint32_t from, std::uint32_t to) const {
  return std::abs(ground_.height[to] - ground_.height[from]) <= kKerbLow_m;
}

void RegionParts::findParts(std::uint32_t slot) {
  const std::uint32_t begin = slot * kCellsOfTile, end = begin + kCellsOfTile;
  std::vector<std::uint8_t> left(is_open_.begin() + begin, is_open_.begin() + end);
  std::vector<std::uint32_t> part;
  for (std::uint32_t start = begin; start < end; ++start) {
    if (left[start - begin] == 0) continue;
    left[start - begin] = 0;
    part.assign(1, start);
    for (std::size_t at = 0; at < part.size(); ++at)
      for (const auto& [dx, dy] : kAroundCell) {
        const std::uint32_t near = ground_.cells.step(part[at], dx, dy);
        if (near < begin || near >= end || left[near - begin] == 0 || !isCrossed(part[at], near)) continue;
        left[near - begin] = 0;
        part.push_back(near);
      }
    addPart(slot, part);
  }
}

void RegionParts::addPart(std::uint32_t slot, const std::vector<std::uint32_t>& cells) {
  constexpr double least_cells = kLeastRegion_m2 / (kWayCell_m * kWayCell_m);
  if (static_cast<double>(cells.size()) < least_cells && std::none_of(cells.begin(), cells.end(), isOnBorder)) return;
  RegionPart part{static_cast<std::uint16_t>(cells.front() % kCellsOfTile),
                  static_cast<std::uint16_t>(cells.size()),
                  kCellsPerTile - 1,
                  kCellsPerTile - 1,
                  0,
                  0};
  for (const std::uint32_t cell : cells) {
    const auto x = static_cast<std::uint8_t>(cell % kCellsPerTile);
    const auto y = static_cast<std::uint8_t>(cell % kCellsOfTile / kCellsPerTile);
    part.min_x = std::min(part.min_x, x), part.max_x = std::max(part.max_x, x);
    part.min_y = std::min(part.min_y, y), part.max_y = std::max(part.max_y, y);
    part_at_[cell] = static_cast<std::uint16_t>(parts_[slot].size());
  }
  parts_[slot].push_back(part);
}

std::vector<RegionLink> RegionParts::linksOf(std::uint32_t slot) const {
  std::vector<RegionLink> links;
  const auto look = [&](int x, int y) {
    const std::uint32_t cell = slot * kCellsOfTile + static_cast<std::uint32_t>(y * kCellsPerTile + x);
    if (part_at_[cell] == kNoRegion) return;
    for (const auto& [dx, dy] : kAroundCell) {
      const std::uint32_t near = ground_.cells.step(cell, dx, dy);
      if (near == kNoCell || near / kCellsOfTile >= slot || is_open_[near] == 0 || !isCrossed(cell, near)) continue;
      links.push_back({ringAt(x + dx, y + dy), part_at_[cell], part_at_[near]});
    }
  };
  for (int i = 0; i < kCellsPerTile; ++i) look(i, 0), look(0, i);
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  return links;
}

}  // namespace cluxel::mapping
