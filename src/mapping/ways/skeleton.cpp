// SPDX-License-Identifier: Apache-2.0
// Thinning in the order of the distance to the edge, by the two colours of a chessboard.
#include "mapping/ways/skeleton.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace cluxel::mapping {

namespace {

/// Whether a cell within these neighbours (bit i: kAroundCell[i] is inside) can be removed without connecting or
/// disconnecting other cells: Yokoi's connectivity number is one.
constexpr bool isSimple(unsigned around) {
  const auto outside = [around](unsigned i) { return 1U - (around >> (i % 8) & 1U); };
  unsigned number = 0;
  for (unsigned i = 0; i < 8; i += 2) number += outside(i) - outside(i) * outside(i + 1) * outside(i + 2);
  return number == 1;
}

constexpr auto kIsSimple = [] {
  std::array<bool, 256> table{};
  for (unsigned around = 0; around < table.size(); ++around) table[around] = isSimple(around);
  return table;
}();

unsigned aroundCell(const TileCells& cells, const std::vector<std::uint8_t>& inside, std::uint32_t cell) {
  unsigned around = 0;
  for (unsigned i = 0; i < 8; ++i) {
    const std::uint32_t near = cells.step(cell, kAroundCell[i][0], kAroundCell[i][1]);
    if (near != kNoCell && inside[near] != 0) around |= 1U << i;
  }
  return around;
}

/// Takes cells away in steps. In a step all cells of one colour of a chessboard are judged at once, of those that lie
/// near enough to the edge: two neighbours of one colour touch at a corner only, and then neither changes whether the
/// other may go. So patches stay connected as they are, and each step carries a change one cell farther, no more.
class Thinning {
 public:
  Thinning(const TileCells& cells, const std::vector<std::uint16_t>& edge_distance2, int levels,
           std::uint16_t end_distance2)
      : cells_(cells),
        edge_distance2_(edge_distance2),
        end_distance2_(end_distance2),
        waiting_(2 * static_cast<std::size_t>(levels)),
        awaits_(edge_distance2.size(), kNoStep),
        left_(edge_distance2.size()) {
    for (std::size_t distance2 = 0; distance2 < level_of_.size(); ++distance2)
      level_of_[distance2] = static_cast<std::uint8_t>(std::ceil(2 * std::sqrt(static_cast<double>(distance2))));
  }

  std::vector<std::uint8_t> run() {
    for (std::uint32_t cell = 0; cell < cells_.size(); ++cell) left_[cell] = edge_distance2_[cell] != 0 ? 1 : 0;
    constexpr std::uint16_t edge = 2;  // of cells that have a neighbour outside, over corners
    for (std::uint32_t cell = 0; cell < cells_.size(); ++cell)
      if (left_[cell] != 0 && edge_distance2_[cell] <= edge) await(cell, 0);
    for (std::size_t step = 0; step < waiting_.size(); ++step) take(step);
    return std::move(left_);
  }

 private:
  /// Puts a cell on the list of the first step from `step` on that judges it. Each step goes half a cell deeper.
  void await(std::uint32_t cell, std::size_t step) {
    const std::size_t colour = (cell + cell / kCellsPerTile) % 2;
    step = std::max(step, std::size_t{level_of_[edge_distance2_[cell]]} - 2);
    step += (step + colour) % 2;
    if (step >= waiting_.size() || awaits_[cell] == step) return;
    awaits_[cell] = static_cast<std::uint8_t>(step);
    waiting_[step].push_back(cell);
  }

  bool mayGo(std::uint32_t cell) const {
    const unsigned around = aroundCell(cells_, left_, cell);
    return kIsSimple[around] && !(std::has_single_bit(around) && edge_distance2_[cell] >= end_distance2_);
  }

  void take(std::size_t step) {
    std::vector<std::uint32_t> gone;
    for (const std::uint32_t cell : waiting_[step])
      if (left_[cell] != 0 && mayGo(cell)) gone.push_back(cell);
    for (const std::uint32_t cell : gone) left_[cell] = 0;
    for (const std::uint32_t cell : gone)
      for (const auto& [dx, dy] : kAroundCell)
        if (const std::uint32_t near = cells_.step(cell, dx, dy); near != kNoCell && left_[near] != 0)
          await(near, step + 1);
    waiting_[step] = {};
  }

  static constexpr std::uint8_t kNoStep = 0xff;

  const TileCells& cells_;
  const std::vector<std::uint16_t>& edge_distance2_;
  std::uint16_t end_distance2_;
  std::array<std::uint8_t, kFarthestEdge * kFarthestEdge + 1>
      level_of_{};                                   ///< half cells, rounded up, of each squared distance
  std::vector<std::vector<std::uint32_t>> waiting_;  ///< the cells that each step judges
  std::vector<std::uint8_t> awaits_;                 ///< the last list that has each cell
  std::vector<std::uint8_t> left_;
};

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
                                     int levels, std::uint16_t end_distance2) {
  return Thinning(cells, edge_distance2, levels, end_distance2).run();
}

}  // namespace cluxel::mapping
