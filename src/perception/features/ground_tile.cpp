// SPDX-License-Identifier: Apache-2.0
// Ground of a tile: remove sunken cells, remove cells above the slope cone (first as measured, then relative to the
// terrain's trend), fill the rest.
#include "perception/features/ground_tile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "perception/clustering/local_steps.hpp"
#include "perception/features/ground_window.hpp"
#include "perception/tile_bytes.hpp"

namespace cluxel::perception {
namespace {

/// Half the width of the averaging square of the terrain's trend [cells]; the square is about 6 m wide.
constexpr int kTrendReach = 6;
/// Relative to the trend, ground is less steep and less rough by this factor.
constexpr double kTrendFactor = 0.4;

/// A multiple of the tile size below all stacks of the ring [m, map]. Heights above it are small, so that sums and
/// means of them as floats do not depend on how high the ground lies.
double baseOf(const Ring<CluxelTile>& ring) {
  float lowest = std::numeric_limits<float>::infinity();
  for (const CluxelTile* tile : ring)
    if (tile != nullptr)
      for (const CellStack& stack : tile->stacks)
        if (stack.count > 0) lowest = std::min(lowest, stack.low);
  return std::isfinite(lowest) ? kTileSize_m * std::floor(double{lowest} / kTileSize_m) : 0;
}

/// Heights above `base_m`.
HeightWindow windowOf(const Ring<CluxelTile>& ring, double base_m) {
  HeightWindow window(3 * kStacksPerTile);
  for (int r = 0; r < 9; ++r) {
    const CluxelTile* tile = ring[static_cast<std::size_t>(r)];
    if (tile == nullptr) continue;
    for (int y = 0; y < kStacksPerTile; ++y)
      for (int x = 0; x < kStacksPerTile; ++x) {
        const CellStack& stack = tile->stacks[static_cast<std::size_t>(y * kStacksPerTile + x)];
        const std::size_t cell = window.at(r % 3 * kStacksPerTile + x, r / 3 * kStacksPerTile + y);
        window.height[cell] = stack.count == 0 ? HeightWindow::kUnknown : static_cast<float>(stack.low - base_m);
      }
  }
  return window;
}

/// Keeps the cells that also pass after subtracting the terrain's trend, which distinguishes steps from slopes.
void dropRaisedAgainstTrend(HeightWindow& window, const GroundParams& params) {
  const auto trend = smoothed(filled(window), window.side, kTrendReach);
  HeightWindow level = window;
  for (std::size_t i = 0; i < level.size(); ++i) level.height[i] -= trend[i];
  dropRaisedCells(level, kStackSize_m, params.steepest * kTrendFactor, params.step_m * 0.75);
  for (std::size_t i = 0; i < level.size(); ++i)
    window.height[i] = level.knows(i) ? window.height[i] : HeightWindow::kUnknown;
}

/// Linear interpolation between cell centres along one axis.
struct Between {
  int cell = 0;
  double share = 0;  ///< weight of the next cell
};

Between between(double local_m) {
  const double cells = local_m / kStackSize_m - 0.5;
  const double low = std::floor(cells);
  return {static_cast<int>(low), cells - low};
}

}  // namespace

void describe(GroundParams& params, ParameterVisitor& visitor) {
  visitor.real({"ground.steepest", "1", 0.05, 5.0, "rise over run that natural ground may have"}, params.steepest);
  visitor.real({"ground.step", "m", 0.02, 2.0, "height above the slope cone that still counts as ground"},
               params.step_m);
}

GroundTile groundOf(const Ring<CluxelTile>& ring, const GroundParams& params) {
  const double base_m = baseOf(ring);
  HeightWindow window = windowOf(ring, base_m);
  dropSunkenCells(window, kStackSize_m, params.steepest, params.step_m);
  dropRaisedCells(window, kStackSize_m, params.steepest, params.step_m);
  dropRaisedAgainstTrend(window, params);
  const auto height = filled(window);
  GroundTile tile{ring[kRingCentre]->key, {}, {}};
  for (int y = 0; y < kStacksPerTile; ++y)
    for (int x = 0; x < kStacksPerTile; ++x) {
      const std::size_t cell = window.at(kStacksPerTile + x, kStacksPerTile + y);
      tile.height.push_back(toHeightStep(base_m + height[cell]));
      tile.source.push_back(window.knows(cell) ? GroundSource::Measured : GroundSource::Filled);
    }
  return tile;
}

double groundHeightAt(const Ring<GroundTile>& ring, double x_local, double y_local) {
  const auto mixed = [](double low, double high, double share) { return low * (1 - share) + high * share; };
  const double cells_x = x_local / kStackSize_m - 0.5, cells_y = y_local / kStackSize_m - 0.5;
  if (cells_x >= 0 && cells_y >= 0 && cells_x < kStacksPerTile - 1 && cells_y < kStacksPerTile - 1) {
    const auto x = static_cast<int>(cells_x),
               y = static_cast<int>(cells_y);  // the usual case: all four cells are in the centre tile
    const float* here = ring[kRingCentre]->height.data() + y * kStacksPerTile + x;
    const double share_x = cells_x - x;
    return mixed(mixed(here[0], here[1], share_x), mixed(here[kStacksPerTile], here[kStacksPerTile + 1], share_x),
                 cells_y - y);
  }
  const auto cellAt = [&](int x, int y) -> double {
    const int last = kStacksPerTile - 1;
    const int stack = 1 + (x < 0 ? -1 : x > last ? 1 : 0), row = 1 + (y < 0 ? -1 : y > last ? 1 : 0);
    const GroundTile* tile = ring[static_cast<std::size_t>(3 * row + stack)];
    if (tile == nullptr) {
      tile = ring[kRingCentre];
      x = std::clamp(x, 0, last);
      y = std::clamp(y, 0, last);
    }
    const int u = (x + kStacksPerTile) % kStacksPerTile, v = (y + kStacksPerTile) % kStacksPerTile;
    return tile->height[static_cast<std::size_t>(v * kStacksPerTile + u)];
  };
  const double limit_m = 2.0 * kTileSize_m - kStackSize_m;
  const Between x = between(std::clamp(x_local, -kTileSize_m + kStackSize_m, limit_m));
  const Between y = between(std::clamp(y_local, -kTileSize_m + kStackSize_m, limit_m));
  const double low = mixed(cellAt(x.cell, y.cell), cellAt(x.cell + 1, y.cell), x.share);
  const double high = mixed(cellAt(x.cell, y.cell + 1), cellAt(x.cell + 1, y.cell + 1), x.share);
  return mixed(low, high, y.share);
}

std::string toBytes(const GroundTile& tile) {
  TileWriter writer("GRND", 2, tile.key);
  writer.put(tile.height);
  writer.put(tile.source);
  return writer.take();
}

GroundTile groundTileFromBytes(std::string_view bytes) {
  TileReader reader(bytes, "GRND", 2);
  constexpr auto kCells = static_cast<std::size_t>(kStacksPerTile) * kStacksPerTile;
  GroundTile tile{reader.key(), reader.getMany<float>(kCells), reader.getMany<GroundSource>(kCells)};
  reader.require(allWithin(tile.height, 2 * kMaxHeight_m), "has a ground height that is not a number");
  for (const auto source : tile.source)
    reader.require(source <= GroundSource::Filled, "has an unknown source of ground");
  reader.finish();
  return tile;
}

}  // namespace cluxel::perception
