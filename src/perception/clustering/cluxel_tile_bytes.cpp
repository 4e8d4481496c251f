// SPDX-License-Identifier: Apache-2.0
// Stored form of cluxels.
#include "perception/clustering/cluxel_tile.hpp"
#include "perception/tile_bytes.hpp"

namespace cluxel::perception {

template <>
inline constexpr bool kFlat<Moments> = true;
static_assert(sizeof(Moments) == 40 && sizeof(CellStack) == 24, "stored structs have no padding");

namespace {

/// Coordinates may exceed the tile by one reach; heights are in the map frame.
bool isPlace(const std::vector<Eigen::Vector3f>& places) {
  return allWithin(places, kMaxHeight_m);
}

bool isUsable(const std::vector<Moments>& moments, bool inside_tile) {
  for (const auto& m : moments) {
    if (!(m.count >= 1) || !m.mean.allFinite() || !(m.mean.cwiseAbs().maxCoeff() <= kMaxHeight_m)) return false;
    if (!allWithin(m.scatter, 1e12)) return false;
    const auto size = static_cast<float>(kTileSize_m);
    if (inside_tile && !(m.mean.x() >= 0 && m.mean.x() < size && m.mean.y() >= 0 && m.mean.y() < size)) return false;
  }
  return true;
}

bool isUsable(const std::vector<CellStack>& stacks) {
  for (const auto& stack : stacks)
    if (!(std::abs(stack.low) <= kMaxHeight_m && std::abs(stack.high) <= kMaxHeight_m) ||
        std::abs(static_cast<double>(stack.base_slice)) > kMaxHeight_m / kSliceHeight_m + 1)
      return false;
  return true;
}

}  // namespace

std::string toBytes(const CluxelTile& tile) {
  TileWriter writer("CLUX", 1, tile.key);
  writer.put(tile.seed);
  writer.put(tile.own);
  writer.put(tile.box_min);
  writer.put(tile.box_max);
  writer.put(tile.volume_min);
  writer.put(tile.volume_max);
  writer.put(tile.ball);
  writer.put(tile.reach);
  writer.put(tile.intensity_mean);
  writer.put(tile.intensity_deviation);
  writer.put(tile.point_cluxel);
  writer.put(tile.stacks);
  return writer.take();
}

CluxelTile cluxelTileFromBytes(std::string_view bytes) {
  TileReader reader(bytes, "CLUX", 1);
  CluxelTile tile;
  tile.key = reader.key();
  tile.seed = reader.getMany<std::uint32_t>();
  const std::size_t size = tile.size();
  tile.own = reader.getMany<Moments>(size);
  tile.box_min = reader.getMany<Eigen::Vector3f>(size);
  tile.box_max = reader.getMany<Eigen::Vector3f>(size);
  tile.volume_min = reader.getMany<Eigen::Vector3f>(size);
  tile.volume_max = reader.getMany<Eigen::Vector3f>(size);
  tile.ball = reader.getMany<Moments>(size);
  tile.reach = reader.getMany<float>(size);
  tile.intensity_mean = reader.getMany<float>(size, true);
  tile.intensity_deviation = reader.getMany<float>(tile.intensity_mean.size());
  tile.point_cluxel = reader.getMany<std::uint32_t>();
  tile.stacks = reader.getMany<CellStack>(static_cast<std::size_t>(kStacksPerTile) * kStacksPerTile);
  reader.require(allBelow(tile.point_cluxel, size), "gives a point to a cluxel that is not there");
  reader.require(allBelow(tile.seed, tile.point_cluxel.size()), "has a seed that is not a point");
  reader.require(isPlace(tile.box_min) && isPlace(tile.box_max) && isPlace(tile.volume_min) && isPlace(tile.volume_max),
                 "has a box that is not a number");
  reader.require(isUsable(tile.own, true) && isUsable(tile.ball, false), "has moments that are not numbers");
  reader.require(isUsable(tile.stacks) && allWithin(tile.reach, 2 * kMaxReach_m),
                 "has stacks or reaches that are not numbers");
  reader.finish();
  return tile;
}

}  // namespace cluxel::perception
