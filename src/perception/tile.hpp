// SPDX-License-Identifier: Apache-2.0
// The fixed tiles of a map: the unit of computing, storing and invalidating.
#pragma once

#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <set>

#include <Eigen/Core>

namespace cluxel::perception {

/// The edge of a tile [m]: a multiple of the largest cluxel radius, and exact as a float.
inline constexpr double kTileSize_m = 16.0;

struct TileKey {
  std::int32_t x = 0, y = 0;
  auto operator<=>(const TileKey&) const = default;
};

/// Where the tiles of a map lie. Their borders are at whole multiples of the tile size in the outer frame, and so is
/// the height from which slices are counted: another origin of the map frame moves them with the points. It also knows
/// how local coordinates are rounded, because whoever finds the tile of a point needs these.
class TileGrid {
 public:
  /// The map frame is the outer frame, or its origin lies at whole tiles.
  TileGrid() = default;
  /// `map_origin`: of the map frame in the outer frame [m].
  explicit TileGrid(const Eigen::Vector3d& map_origin);
  static TileGrid at(const Eigen::Vector3d& corner) {
    TileGrid grid;
    grid.corner_ = corner;
    return grid;
  }
  /// The same tiles in a map of stages 20 or earlier, whose local heights are the nearest floats.
  TileGrid withHeightsAsMeasured() const {
    TileGrid grid = *this;
    grid.rounds_heights_ = false;
    return grid;
  }

  /// The corner of tile (0, 0), which holds the map's origin [m, map]. Zero when the origin lies at whole tiles.
  const Eigen::Vector3d& corner() const { return corner_; }
  /// Whether local heights are rounded to kHeightStep_m (local_steps.hpp).
  bool roundsHeights() const { return rounds_heights_; }
  bool operator==(const TileGrid& other) const {
    return corner_ == other.corner_ && rounds_heights_ == other.rounds_heights_;
  }

  /// A point of the map relative to corner() [m]. Unless that is zero, it is rounded to 15 nm: scanners and files
  /// round coordinates, so that many lie on borders of tiles and voxels, and must stay there.
  Eigen::Vector3d fromMap(const Eigen::Vector3d& p_map) const {
    if (corner_.isZero(0)) return p_map;
    // Adding it to a smaller number leaves no bits below the step.
    constexpr double kRounding_m = 1.5 * (1 << 26), kLargest_m = 1 << 24;
    const auto rounded = [](double value_m) {
      return std::abs(value_m) < kLargest_m ? (value_m + kRounding_m) - kRounding_m : value_m;
    };
    const Eigen::Vector3d p = p_map - corner_;
    return {rounded(p.x()), rounded(p.y()), rounded(p.z())};
  }
  TileKey tileOf(const Eigen::Vector3d& p_map) const {
    const Eigen::Vector3d p = fromMap(p_map);
    return {static_cast<std::int32_t>(std::floor(p.x() / kTileSize_m)),
            static_cast<std::int32_t>(std::floor(p.y() / kTileSize_m))};
  }
  /// The corner of a tile with the smallest x and y, at the height from which slices are counted [m, map]. Local floats
  /// of the tile are relative to it.
  Eigen::Vector3d cornerOf(const TileKey& key) const {
    return {corner_.x() + key.x * kTileSize_m, corner_.y() + key.y * kTileSize_m, corner_.z()};
  }

 private:
  Eigen::Vector3d corner_ = Eigen::Vector3d::Zero();
  bool rounds_heights_ = true;
};

inline TileGrid::TileGrid(const Eigen::Vector3d& map_origin) {
  for (int axis = 0; axis < 3; ++axis) {
    const double beyond_m = map_origin[axis] - kTileSize_m * std::floor(map_origin[axis] / kTileSize_m);
    if (beyond_m > 0 && beyond_m < kTileSize_m) corner_[axis] = -beyond_m;
  }
}

/// The tile itself and its 8 neighbours, row by row from (x-1, y-1); entry 4 is the tile itself.
inline std::array<TileKey, 9> ringOf(const TileKey& key) {
  std::array<TileKey, 9> ring;
  for (int i = 0; i < 9; ++i) ring[static_cast<std::size_t>(i)] = {key.x + i % 3 - 1, key.y + i / 3 - 1};
  return ring;
}
inline constexpr int kRingCentre = 4;
/// Where the tile itself is in the ring of the one at `place`.
constexpr std::size_t opposite(std::size_t place) {
  return 8 - place;
}

/// One stage's stored outputs of a tile and its 8 neighbours, in the order of ringOf(); null where there is none.
template <typename Tile>
using Ring = std::array<const Tile*, 9>;

/// The ring around `key` in a map from TileKey to tiles.
template <typename Tiles>
auto ringIn(const Tiles& tiles, const TileKey& key) {
  Ring<typename Tiles::mapped_type> ring{};
  const auto keys = ringOf(key);
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (const auto found = tiles.find(keys[i]); found != tiles.end()) ring[i] = &found->second;
  return ring;
}

/// The corner of a ring tile relative to the corner of the centre tile [m]; exact.
inline Eigen::Vector3f ringShift(int ring) {
  return {static_cast<float>(ring % 3 - 1) * static_cast<float>(kTileSize_m),
          static_cast<float>(ring / 3 - 1) * static_cast<float>(kTileSize_m), 0.0F};
}

/// Where a tile lies on a curve through all tiles on which most neighbours are close to each other (Morton order).
constexpr std::uint64_t mortonCode(const TileKey& key) {
  const auto spread = [](std::int32_t value) {
    std::uint64_t bits = static_cast<std::uint32_t>(value) ^ 0x8000'0000U;  // so that negative numbers come first
    bits = (bits | bits << 16U) & 0x0000'FFFF'0000'FFFFU;
    bits = (bits | bits << 8U) & 0x00FF'00FF'00FF'00FFU;
    bits = (bits | bits << 4U) & 0x0F0F'0F0F'0F0F'0F0FU;
    bits = (bits | bits << 2U) & 0x3333'3333'3333'3333U;
    return (bits | bits << 1U) & 0x5555'5555'5555'5555U;
  };
  return spread(key.x) | spread(key.y) << 1U;
}

using TileSet = std::set<TileKey>;

/// The tiles and their neighbours, as far as they are in `existing`.
inline TileSet withRing(const TileSet& tiles, const TileSet& existing) {
  TileSet all;
  for (const TileKey& tile : tiles)
    for (const TileKey& near : ringOf(tile))
      if (existing.contains(near)) all.insert(near);
  return all;
}

/// The tiles with all those around them, whether there is anything in them or not.
inline TileSet grown(const TileSet& tiles) {
  TileSet all;
  for (const TileKey& tile : tiles)
    for (const TileKey& near : ringOf(tile)) all.insert(near);
  return all;
}

inline TileSet unionOf(TileSet a, const TileSet& b) {
  a.insert(b.begin(), b.end());
  return a;
}

inline TileSet without(TileSet tiles, const TileSet& others) {
  for (const TileKey& key : others) tiles.erase(key);
  return tiles;
}

/// A cluxel relative to a tile: the position of its tile in the ring, and its number in that tile.
struct RingIndex {
  std::uint32_t ring : 4 = kRingCentre;
  std::uint32_t index : 28 = 0;
  bool operator==(const RingIndex&) const = default;
};

}  // namespace cluxel::perception
