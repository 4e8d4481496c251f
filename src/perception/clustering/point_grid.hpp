// SPDX-License-Identifier: Apache-2.0
// Points of a tile and of a margin around it, sorted by cell, and iteration over each cell's neighbourhood.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "perception/clustering/tile_points.hpp"

namespace cluxel::perception {

/// Points with their cells, in the order (cell x, y, z; then tile of the ring; then number in the tile).
struct PointGrid {
  static constexpr std::uint32_t kForeign = 0xffffffffU;
  static constexpr std::size_t kSpare =
      3;                                ///< zeros after the last point: a whole SIMD vector may be read from any point
  std::vector<float> x, y, z;           ///< relative to the centre tile's corner
  std::vector<std::uint32_t> own;       ///< number in the centre tile, or kForeign
  std::vector<std::uint64_t> cell_key;  ///< per occupied cell, ascending; then the sentinels of endKeys()
  std::vector<std::uint32_t> cell_start;  ///< first point per occupied cell, and the end

  std::size_t cells() const { return cell_start.size() - 1; }
};

/// Cells are a little larger than `cell_m`: 1.0001 times as wide, and as high as the next whole fraction of a tile's
/// width (0.20 m: 0.20002 m wide and 0.2025 m high). Includes points of neighbouring tiles that are nearer than
/// `margin_m` to the centre tile.
PointGrid gridOf(const Ring<TilePoints>& ring, double cell_m, double margin_m);

/// The key of the cell that holds a local point: neighbours in z differ by 1, in y by kCellStrideY, in x by
/// kCellStrideX.
inline constexpr std::uint64_t kCellStrideY = std::uint64_t{1} << 24U;
inline constexpr std::uint64_t kCellStrideX = std::uint64_t{1} << 36U;
class CellKeys {
 public:
  /// `margin_m`: how far coordinates may lie outside the tile.
  CellKeys(double cell_m, double margin_m);
  std::uint64_t operator()(float x, float y, float z) const {
    return cell(x, offset_) * kCellStrideX + cell(y, offset_) * kCellStrideY + layer(z);
  }
  /// Squared distances from a position to the 9 cell stacks around it, in the order of NeighbourWalk [m2]; slightly too
  /// small, so that rounding never excludes a stack.
  std::array<float, 9> gapsAround(float x, float y) const {
    const auto squaresAlong = [&](double value_m) {
      constexpr double kSpare_m = 1e-3;
      const double cells = (value_m + offset_) * per_m_,
                   share = cells - static_cast<double>(static_cast<std::uint64_t>(cells));
      const auto squareOf = [&](double part) {
        const auto gap_m = static_cast<float>(std::max(0.0, part / per_m_ - kSpare_m));
        return gap_m * gap_m;
      };
      return std::array<float, 3>{squareOf(share), 0.0F, squareOf(1.0 - share)};
    };
    const auto along_x = squaresAlong(x), along_y = squaresAlong(y);
    std::array<float, 9> gaps;
    for (std::size_t k = 0; k < 9; ++k) gaps[k] = along_x[k / 3] + along_y[k % 3];
    return gaps;
  }

 private:
  /// Above the greatest depth, so that no layer is below 0. A multiple of the tile size, from which layers count.
  static constexpr double kHeightOffset_m = kMaxHeight_m + 16.0;
  static_assert(kHeightOffset_m / kTileSize_m == static_cast<std::int64_t>(kHeightOffset_m / kTileSize_m));
  std::uint64_t cell(double value_m, double offset_m) const {
    return static_cast<std::uint64_t>((value_m + offset_m) * per_m_);
  }
  std::uint64_t layer(double height_m) const {
    return static_cast<std::uint64_t>((height_m + kHeightOffset_m) * layers_per_m_);
  }
  double per_m_, offset_;
  /// A whole number of layers is as high as a tile is wide, so that another origin of the grid, which differs by whole
  /// tiles, leaves the points of each layer together.
  double layers_per_m_;
};

/// Appends sentinel keys larger than any cell's: the walk reads a few keys past the end.
void endKeys(std::vector<std::uint64_t>& cell_key);

/// Visits cells in ascending order and keeps, for each of the 9 cell stacks around, the range of its 3 cells. Order of
/// the stacks by (x, y): (-1,-1), (-1,0), (-1,1), (0,-1), (0,0), ...
class NeighbourWalk {
 public:
  static constexpr std::size_t kAll = 9, kEarlier = 5;  ///< all stacks; the stacks that hold earlier cells

  /// `cell_key` must end with the sentinels of endKeys().
  explicit NeighbourWalk(const std::vector<std::uint64_t>& cell_key) : cell_key_(cell_key) {}

  /// Moves to the cell with key `key`, which must not be before the last one. Occupied cells of stack k: [first(k),
  /// last(k)).
  template <std::size_t kStacks = kAll>
  void moveTo(std::uint64_t key) {
    const std::uint64_t* keys = cell_key_.data();
    for (std::size_t k = 0; k < kStacks; ++k) {
      const std::uint64_t stack = key + (k / 3) * kCellStrideX + (k % 3) * kCellStrideY - kCellStrideX - kCellStrideY;
      std::size_t first = first_[k];
      // Usually one or two cells further; branchless, since the branch would be mispredicted half of the time.
      for (int step = 0; step < 2; ++step) first += keys[first] + 1 < stack ? 1U : 0U;
      while (keys[first] + 1 < stack) ++first;
      first_[k] = first;
      std::size_t last = first;
      for (std::size_t i = 0; i < 3; ++i) last += keys[first + i] <= stack + 1 ? 1U : 0U;
      last_[k] = last;
    }
  }
  std::size_t first(std::size_t k) const { return first_[k]; }
  std::size_t last(std::size_t k) const { return last_[k]; }

 private:
  const std::vector<std::uint64_t>& cell_key_;
  std::array<std::size_t, kAll> first_{}, last_{};
};

}  // namespace cluxel::perception
