// SPDX-License-Identifier: Apache-2.0
// Stored form of cluxels: which points belong together; everything else follows from the points.
#include "perception/clustering/cluxel_tile.hpp"
#include "perception/clustering/cluxel_volumes.hpp"
#include "perception/tile_bytes.hpp"

namespace cluxel::perception {

template <>
inline constexpr bool kFlat<Moments> = true;
static_assert(sizeof(Moments) == 40 && sizeof(CellStack) == 24, "digested structs have no padding");

namespace {

bool areOfTheirCluxels(const CluxelTile& tile) {
  for (std::uint32_t c = 0; c < tile.size(); ++c)
    if (tile.point_cluxel[tile.seed[c]] != c) return false;
  return true;
}

}  // namespace

std::string toBytes(const CluxelTile& tile) {
  TileWriter writer("CLUX", 2, tile.key);
  writer.putSteps(tile.seed);
  writer.putSteps(tile.point_cluxel);
  writer.leaveOut(tile.own);
  writer.leaveOut(tile.box_min);
  writer.leaveOut(tile.box_max);
  writer.leaveOut(tile.volume_min);
  writer.leaveOut(tile.volume_max);
  writer.leaveOut(tile.ball);
  writer.leaveOut(tile.reach);
  writer.leaveOut(tile.intensity_mean);
  writer.leaveOut(tile.intensity_deviation);
  writer.leaveOut(tile.stacks);
  return writer.take();
}

CluxelTile cluxelTileFromBytes(std::string_view bytes, const TilePoints& points) {
  TileReader reader(bytes, "CLUX", 2);
  CluxelTile tile;
  tile.key = reader.key();
  tile.seed = reader.getSteps();
  tile.point_cluxel = reader.getSteps();
  reader.require(tile.point_cluxel.size() == points.size(), "is of other points");
  reader.require(allBelow(tile.point_cluxel, tile.size()), "gives a point to a cluxel that is not there");
  reader.require(allBelow(tile.seed, points.size()), "has a seed that is not a point");
  reader.require(areOfTheirCluxels(tile), "has a seed that belongs to another cluxel");
  reader.finish();
  measureOwn(points, tile);
  return tile;
}

}  // namespace cluxel::perception
