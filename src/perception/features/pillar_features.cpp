// SPDX-License-Identifier: Apache-2.0
// Occupancy around a cluxel at its own height: a pole has nothing beside it, a wall continues on two sides, leaves are
// everywhere. Cells are occupied or free, so the density of points matters little.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "perception/clustering/fast_floor.hpp"
#include "perception/features/feature_groups.hpp"

namespace cluxel::perception {
namespace {

constexpr double kCell_m = 0.25;
constexpr int kReach = 3;  ///< radius of the neighbourhood [cells]
constexpr int kCore = 1;   ///< radius of the core, which belongs to the object itself [cells]
constexpr int kTileCells = static_cast<int>(kTileSize_m / kCell_m);
constexpr int kSide = kTileCells + 2 * kReach + 1;  // one cell of padding: rows are read eight cells at a time
static_assert((kReach + 1) * kCell_m <= kFeatureMargin_m);
constexpr double kBelowGround_m = 2.0;         ///< depth of the lowest slice below the tile's lowest ground
constexpr int kOwnHeight = 2, kFarHeight = 6;  ///< half heights of the windows [slices]: 0.5 m and 1.5 m
constexpr std::size_t kPillarColumns = 7;

/// Occupied slices of kCell_m height in each cell; the first and last slice include everything below and above.
class Occupancy {
 public:
  Occupancy(const Ring<CluxelTile>& ring, const GroundTile& ground)
      : base_m_(*std::min_element(ground.height.begin(), ground.height.end()) - kBelowGround_m),
        slices_(static_cast<std::size_t>(kSide) * kSide) {
    for (int r = 0; r < 9; ++r)
      if (const CluxelTile* tile = ring[static_cast<std::size_t>(r)]) enter(*tile, ringShift(r));
  }
  /// The cells of a row from (x, y) on.
  const std::uint64_t* from(int x, int y) const {
    return slices_.data() + static_cast<std::size_t>((y + kReach) * kSide + x + kReach);
  }
  int sliceOf(double z) const { return static_cast<int>(std::clamp((z - base_m_) / kCell_m, 0.0, 63.0)); }
  static int cellOf(float local_m) {
    return static_cast<int>(fastFloor(static_cast<double>(local_m / static_cast<float>(kCell_m))));
  }

 private:
  void enter(const CluxelTile& tile, const Eigen::Vector3f& shift) {
    for (std::size_t i = 0; i < tile.size(); ++i) {
      const int x = cellOf(tile.own[i].mean.x() + shift.x()) + kReach,
                y = cellOf(tile.own[i].mean.y() + shift.y()) + kReach;
      if (x < 0 || y < 0 || x >= kSide || y >= kSide) continue;
      slices_[static_cast<std::size_t>(y * kSide + x)] |=
          between(sliceOf(tile.box_min[i].z()), sliceOf(tile.box_max[i].z()));
    }
  }
  static std::uint64_t between(int low, int high) {
    const std::uint64_t up_to_high = ~std::uint64_t{0} >> static_cast<unsigned>(63 - high);
    return up_to_high & (~std::uint64_t{0} << static_cast<unsigned>(low));
  }

  double base_m_;
  std::vector<std::uint64_t> slices_;
};

/// The direction (of 8) of a cell, seen from the centre cell.
int octantOf(int x, int y) {
  return static_cast<int>(std::lround(std::atan2(y, x) / (std::numbers::pi / 4) + 8)) % 8;
}

/// Eight cells at once; a comparison gives -1 where it holds.
using Cells = std::int16_t __attribute__((vector_size(16)));
constexpr int kWidth = 8;  ///< cells of a row; the last one is padding
constexpr std::size_t kVectors = 2 * kReach + 1;
static_assert(kWidth == 2 * kReach + 2);
using Square = std::array<std::int16_t, kWidth * kVectors>;  // row by row

/// Masks for the cells of the square around a cluxel: whether they are outside the core, and their directions.
struct SquareCells {
  Square ring{}, octant{};
  float count = 0;
  SquareCells() {
    for (int y = -kReach; y <= kReach; ++y)
      for (int x = -kReach; x <= kReach; ++x) {
        if (std::max(std::abs(x), std::abs(y)) <= kCore) continue;
        const auto i = static_cast<std::size_t>((y + kReach) * kWidth + x + kReach);
        ring[i] = -1;
        octant[i] = static_cast<std::int16_t>(1U << static_cast<unsigned>(octantOf(x, y)));
        ++count;
      }
  }
};

/// A window of slices around a cluxel; bit kFarHeight is the slice of the cluxel.
constexpr std::int16_t kLevel = 0x1f0, kAbove = 0x1e00, kBelow = 0x00f;
static_assert(kLevel >> kFarHeight == 0b111 && kOwnHeight == 2 &&
              (kLevel | kAbove | kBelow) == (1 << (2 * kFarHeight + 1)) - 1);

/// The windows of all cells of the square around a position.
Square windowsAround(const Occupancy& occupancy, int x, int y, int slice) {
  Square windows;
  const int lowest = slice - kFarHeight;
  const auto up = static_cast<unsigned>(std::max(-lowest, 0)), down = static_cast<unsigned>(std::max(lowest, 0));
  for (int row = 0; row < static_cast<int>(kVectors); ++row) {
    const std::uint64_t* cells = occupancy.from(x - kReach, y - kReach + row);
    std::int16_t* out = windows.data() + row * kWidth;
    for (int i = 0; i < kWidth; ++i)
      out[i] = static_cast<std::int16_t>((cells[i] >> down << up) & (kLevel | kAbove | kBelow));
  }
  return windows;
}

Cells cellsAt(const Square& square, std::size_t vector) {
  Cells eight;
  std::memcpy(&eight, square.data() + 8 * vector, sizeof eight);
  return eight;
}

/// Sums over the cells outside the core.
struct Around {
  int level = 0, above = 0, below = 0;
  unsigned octants = 0;
};

Around countAround(const Square& windows, const SquareCells& square) {
  Cells level{}, above{}, below{}, octants{};
  for (std::size_t v = 0; v < kVectors; ++v) {
    const Cells cells = cellsAt(windows, v) & cellsAt(square.ring, v), none{};
    const auto on_level = (cells & kLevel) != none, on_above = (cells & kAbove) != none,
               on_below = (cells & kBelow) != none;
    level -= on_level;
    above -= on_above;
    below -= on_below;
    octants |= on_level & cellsAt(square.octant, v);
  }
  Around sums;
  for (std::size_t i = 0; i < 8; ++i) {
    sums.level += level[i], sums.above += above[i], sums.below += below[i];
    sums.octants |= static_cast<unsigned>(octants[i]);
  }
  return sums;
}

/// Occupancy counts around one cluxel at its height.
void fillOne(const Occupancy& occupancy, const SquareCells& square, const Eigen::Vector3f& center,
             std::span<float> out) {
  const int x = Occupancy::cellOf(center.x()), y = Occupancy::cellOf(center.y());
  const Square windows = windowsAround(occupancy, x, y, occupancy.sliceOf(center.z()));
  unsigned core = 0;
  int core_cells = 0;
  for (int v = kReach - kCore; v <= kReach + kCore; ++v)
    for (int u = kReach - kCore; u <= kReach + kCore; ++u) {
      const auto window = static_cast<unsigned>(windows[static_cast<std::size_t>(v * kWidth + u)]);
      core |= window;
      core_cells += (window & kLevel) != 0 ? 1 : 0;
    }
  const Around around = countAround(windows, square);
  out[0] = static_cast<float>(std::popcount(core)) / static_cast<float>(2 * kFarHeight + 1);
  out[1] = static_cast<float>(core_cells);
  out[2] = static_cast<float>(around.level) / square.count;
  out[3] = static_cast<float>(around.above) / square.count;
  out[4] = static_cast<float>(around.below) / square.count;
  out[5] = static_cast<float>(std::popcount(around.octants));
  out[6] = static_cast<float>(std::popcount(around.octants & (around.octants >> 4U) & 0x0fU));
}

}  // namespace

std::vector<std::string> pillarColumns() {
  return {"metric.pillar_core_height",   "metric.pillar_core_cells",   "metric.pillar_beside",
          "metric.pillar_beside_above",  "metric.pillar_beside_below", "metric.pillar_sides",
          "metric.pillar_opposite_sides"};
}

void fillPillarFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows) {
  const CluxelTile& own = input.own();
  const Occupancy occupancy(input.ring, *input.ground[kRingCentre]);
  const SquareCells square;
  for (const std::uint32_t c : input.chosen)
    fillOne(occupancy, square, own.own[c].mean, rows.row(c, column, kPillarColumns));
}

}  // namespace cluxel::perception
