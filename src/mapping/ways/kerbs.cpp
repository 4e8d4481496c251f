// SPDX-License-Identifier: Apache-2.0
// Cells between the two levels are marked.
#include "mapping/ways/kerbs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mapping/ways/ways.hpp"

namespace cluxel::mapping {

namespace {

/// Both sides of a step rise by at most this share of it in the next cell: in a bank it is half or more.
constexpr double kMaxSlant = 0.35;

/// The step at each cell that lies on a kerb [m], else 0.
class KerbSteps {
 public:
  explicit KerbSteps(const GroundCells& ground) : ground_(ground), step_(ground.cells.size(), 0.0F) {
    for (std::uint32_t cell = 0; cell < ground_.cells.size(); ++cell)
      if (ground_.even[cell] != 0)
        for (const auto& [dx, dy] : kAroundCell) look(cell, dx, dy);
    closeGaps();
  }
  std::vector<float> take() { return std::move(step_); }

 private:
  std::optional<double> levelAt(std::uint32_t cell) const {
    if (cell == kNoCell || (ground_.measured[cell] == 0 && ground_.even[cell] == 0)) return std::nullopt;
    return ground_.height[cell];
  }
  /// Looks from the edge of even ground in one direction.
  void look(std::uint32_t cell, int dx, int dy) {
    const TileCells& cells = ground_.cells;
    const std::uint32_t edge = cells.step(cell, dx, dy);
    if (edge == kNoCell || ground_.even[edge] != 0 || ground_.thing[edge] != 0) return;
    const auto here = levelAt(cell), before = levelAt(cells.step(cell, -dx, -dy)),
               beyond = levelAt(cells.step(cell, 2 * dx, 2 * dy)), after = levelAt(cells.step(cell, 3 * dx, 3 * dy));
    if (!beyond || ground_.thing[cells.step(cell, 2 * dx, 2 * dy)] != 0) return;
    const double rise = std::abs(*beyond - *here);
    if (rise < kKerbSeen_m || rise > kKerbHigh_m) return;
    if (before && std::abs(*here - *before) > kMaxSlant * rise) return;
    if (after && std::abs(*after - *beyond) > kMaxSlant * rise) return;
    step_[edge] = std::max(step_[edge], static_cast<float>(rise));
  }
  /// Joins kerbs over gaps of one cell.
  void closeGaps() {
    const std::vector<float> before = step_;
    for (std::uint32_t cell = 0; cell < ground_.cells.size(); ++cell)
      for (std::size_t way = 0; way < kAroundCell.size() / 2 && step_[cell] == 0; ++way) {
        const auto& [dx, dy] = kAroundCell[way];
        const std::uint32_t a = ground_.cells.step(cell, dx, dy), b = ground_.cells.step(cell, -dx, -dy);
        if (a != kNoCell && b != kNoCell && before[a] > 0 && before[b] > 0)
          step_[cell] = 0.5F * (before[a] + before[b]);
      }
  }

  const GroundCells& ground_;
  std::vector<float> step_;
};

}  // namespace

std::vector<float> kerbSteps(const GroundCells& ground) {
  return KerbSteps(ground).take();
}

}  // namespace cluxel::mapping
