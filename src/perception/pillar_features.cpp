// SPDX-License-Identifier: Apache-2.0
// How a cluxel stands among what is around it at its own height: a pole fills its cells and has nothing beside it, a wall
// goes on to two sides, leaves are everywhere. Cells are occupied or not, so density matters little.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "perception/feature_groups.hpp"

namespace cluxel {
namespace {

constexpr double kCell_m = 0.25;
constexpr int kReach = 3;                      ///< cells around the centre cell that are looked at
constexpr int kCore = 1;                       ///< of these, the ones that belong to the thing itself
constexpr int kTileCells = static_cast<int>(kTileSize_m / kCell_m);
constexpr int kSide = kTileCells + 2 * kReach;
constexpr double kBelowGround_m = 2.0;         ///< where the lowest slice lies under the tile's lowest ground
constexpr int kOwnHeight = 2, kFarHeight = 6;  ///< half heights of the windows of slices: 0.5 m and 1.5 m
constexpr std::size_t kPillarColumns = 7;

/// Slices of kCell_m height in each cell; the first and last one stand for all below and above.
class Occupancy {
 public:
  Occupancy(const Ring<CluxelTile>& ring, const GroundTile& ground)
      : base_m_(*std::min_element(ground.height.begin(), ground.height.end()) - kBelowGround_m),
        slices_(static_cast<std::size_t>(kSide) * kSide) {
    for (int r = 0; r < 9; ++r)
      if (const CluxelTile* tile = ring[static_cast<std::size_t>(r)]) enter(*tile, ringShift(r));
  }
  std::uint64_t at(int x, int y) const {
    return slices_[static_cast<std::size_t>((y + kReach) * kSide + x + kReach)];
  }
  int sliceOf(double z) const { return static_cast<int>(std::clamp(std::floor((z - base_m_) / kCell_m), 0.0, 63.0)); }
  static int cellOf(float local_m) { return static_cast<int>(std::floor(local_m / static_cast<float>(kCell_m))); }

 private:
  void enter(const CluxelTile& tile, const Eigen::Vector3f& shift) {
    for (std::size_t i = 0; i < tile.size(); ++i) {
      const int x = cellOf(tile.own[i].mean.x() + shift.x()) + kReach, y = cellOf(tile.own[i].mean.y() + shift.y()) + kReach;
      if (x < 0 || y < 0 || x >= kSide || y >= kSide) continue;
      slices_[static_cast<std::size_t>(y * kSide + x)] |= between(sliceOf(tile.box_min[i].z()), sliceOf(tile.box_max[i].z()));
    }
  }
  static std::uint64_t between(int low, int high) {
    const std::uint64_t up_to_high = ~std::uint64_t{0} >> static_cast<unsigned>(63 - high);
    return up_to_high & (~std::uint64_t{0} << static_cast<unsigned>(low));
  }

  double base_m_;
  std::vector<std::uint64_t> slices_;
};

/// Slices from `low` to `high`, as far as there are.
std::uint64_t windowOf(int low, int high) {
  if (high < 0 || low > 63) return 0;
  const auto first = static_cast<unsigned>(std::max(low, 0)), last = static_cast<unsigned>(std::min(high, 63));
  return (~std::uint64_t{0} >> (63U - last)) & (~std::uint64_t{0} << first);
}

/// Which of 8 directions a cell lies in, seen from the centre cell.
int octantOf(int x, int y) {
  return static_cast<int>(std::lround(std::atan2(y, x) / (std::numbers::pi / 4) + 8)) % 8;
}

struct RingCell {
  int x, y;
  std::uint8_t octant;
};

/// The cells around the core.
std::vector<RingCell> ringCells() {
  std::vector<RingCell> cells;
  for (int y = -kReach; y <= kReach; ++y)
    for (int x = -kReach; x <= kReach; ++x)
      if (std::max(std::abs(x), std::abs(y)) > kCore)
        cells.push_back({x, y, static_cast<std::uint8_t>(1U << static_cast<unsigned>(octantOf(x, y)))});
  return cells;
}

/// Counts of the surroundings at the height of one cluxel.
void fillOne(const Occupancy& occupancy, const std::vector<RingCell>& around, const Eigen::Vector3f& center, std::span<float> out) {
  const int x = Occupancy::cellOf(center.x()), y = Occupancy::cellOf(center.y()), z = occupancy.sliceOf(center.z());
  const std::uint64_t level = windowOf(z - kOwnHeight, z + kOwnHeight), above = windowOf(z + kOwnHeight + 1, z + kFarHeight),
                      below = windowOf(z - kFarHeight, z - kOwnHeight - 1), far = level | above | below;
  std::uint64_t core = 0;
  int core_cells = 0;
  for (int v = y - kCore; v <= y + kCore; ++v)
    for (int u = x - kCore; u <= x + kCore; ++u) {
      core |= occupancy.at(u, v);
      core_cells += (occupancy.at(u, v) & level) != 0 ? 1 : 0;
    }
  int on_level = 0, on_above = 0, on_below = 0;
  std::uint8_t octants = 0;
  for (const auto& cell : around) {
    const std::uint64_t slices = occupancy.at(x + cell.x, y + cell.y);
    on_level += (slices & level) != 0 ? 1 : 0;
    on_above += (slices & above) != 0 ? 1 : 0;
    on_below += (slices & below) != 0 ? 1 : 0;
    octants |= (slices & level) != 0 ? cell.octant : std::uint8_t{0};
  }
  const auto share = [&](int count) { return static_cast<float>(count) / static_cast<float>(around.size()); };
  out[0] = static_cast<float>(std::popcount(core & far)) / static_cast<float>(2 * kFarHeight + 1);
  out[1] = static_cast<float>(core_cells);
  out[2] = share(on_level);
  out[3] = share(on_above);
  out[4] = share(on_below);
  out[5] = static_cast<float>(std::popcount(octants));
  const auto opposite = static_cast<std::uint8_t>(octants & (octants >> 4U) & 0x0fU);
  out[6] = static_cast<float>(std::popcount(opposite));
}

}  // namespace

std::vector<std::string> pillarColumns() {
  return {"metric.pillar_core_height", "metric.pillar_core_cells", "metric.pillar_beside", "metric.pillar_beside_above",
          "metric.pillar_beside_below", "metric.pillar_sides", "metric.pillar_opposite_sides"};
}

void fillPillarFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows) {
  const CluxelTile& own = input.own();
  const Occupancy occupancy(input.ring, *input.ground[kRingCentre]);
  const auto around = ringCells();
  for (std::size_t c = 0; c < own.size(); ++c)
    fillOne(occupancy, around, own.own[c].mean, rows.row(c, column, kPillarColumns));
}

}  // namespace cluxel
