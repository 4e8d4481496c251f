// SPDX-License-Identifier: Apache-2.0
// The fixed tiles of the map frame: the unit of computing, storing and invalidating.
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

inline TileKey tileOf(const Eigen::Vector3d& p_map) {
  return {static_cast<std::int32_t>(std::floor(p_map.x() / kTileSize_m)),
          static_cast<std::int32_t>(std::floor(p_map.y() / kTileSize_m))};
}

/// The corner with the smallest x and y, at z = 0, in the map frame. Local floats of a tile are relative to it.
inline Eigen::Vector3d cornerOf(const TileKey& key) {
  return {key.x * kTileSize_m, key.y * kTileSize_m, 0.0};
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
