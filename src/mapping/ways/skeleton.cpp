// SPDX-License-Identifier: Apache-2.0
// Thinning in the order of the distance to the edge; ties in the order of the cells.
#include "mapping/ways/skeleton.hpp"

#include <algorithm>
#include <bit>
#include <functional>
#include <queue>

namespace cluxel::mapping {

namespace {

/// Whether the cell within these neighbours (bit i: kAroundCell[i] is inside) can be removed without connecting or
/// disconnecting other cells: Yokoi's connectivity number is one.
bool isSimple(unsigned around) {
  const auto outside = [around](unsigned i) { return 1U - (around >> (i % 8) & 1U); };
  unsigned number = 0;
  for (unsigned i = 0; i < 8; i += 2) number += outside(i) - outside(i) * outside(i + 1) * outside(i + 2);
  return number == 1;
}

unsigned aroundCell(const TileCells& cells, const std::vector<std::uint8_t>& inside, std::uint32_t cell) {
  unsigned around = 0;
  for (unsigned i = 0; i < 8; ++i) {
    const std::uint32_t near = cells.step(cell, kAroundCell[i][0], kAroundCell[i][1]);
    if (near != kNoCell && inside[near] != 0) around |= 1U << i;
  }
  return around;
}

}  // namespace

std::vector<std::uint16_t> squaredEdgeDistances(const TileCells& cells, const std::vector<std::uint8_t>& inside) {
  const auto is_in = [&](std::uint32_t cell) { return cell != kNoCell && inside[cell] != 0; };
  std::vector<std::uint8_t> down(inside.size(), 0);  // within the cell's column
  std::vector<std::uint16_t> squared(inside.size(), 0);
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
    if (inside[cell] == 0) continue;
    int d = 1;
    while (d < kFarthestEdge && is_in(cells.step(cell, 0, d)) && is_in(cells.step(cell, 0, -d))) ++d;
    down[cell] = static_cast<std::uint8_t>(d);
  }
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
    if (inside[cell] == 0) continue;
    int best = down[cell] * down[cell];
    for (int side = -1; side <= 1; side += 2)
      for (int d = 1; d * d < best; ++d) {
        const std::uint32_t near = cells.step(cell, side * d, 0);
        const int height = near == kNoCell ? 0 : down[near];
        best = std::min(best, d * d + height * height);
      }
    squared[cell] = static_cast<std::uint16_t>(best);
  }
  return squared;
}

std::vector<std::uint8_t> skeletonOf(const TileCells& cells, const std::vector<std::uint16_t>& edge_distance2,
                                     std::uint16_t end_distance2) {
  std::vector<std::uint8_t> left(edge_distance2.size());
  std::priority_queue<std::uint64_t, std::vector<std::uint64_t>, std::greater<>> open;
  const auto push = [&](std::uint32_t cell) { open.push(std::uint64_t{edge_distance2[cell]} << 32U | cell); };
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) left[cell] = edge_distance2[cell] != 0 ? 1 : 0;
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell)
    if (left[cell] != 0 && aroundCell(cells, left, cell) != 0xffU) push(cell);
  while (!open.empty()) {
    const auto cell = static_cast<std::uint32_t>(open.top() & 0xffffffffU);
    open.pop();
    if (left[cell] == 0) continue;
    const unsigned around = aroundCell(cells, left, cell);
    const bool is_end = std::popcount(around) == 1 && edge_distance2[cell] >= end_distance2;
    if (is_end || !isSimple(around)) continue;
    left[cell] = 0;
    for (unsigned i = 0; i < 8; ++i)
      if ((around >> i & 1U) != 0) push(cells.step(cell, kAroundCell[i][0], kAroundCell[i][1]));
  }
  return left;
}

}  // namespace cluxel::mapping
