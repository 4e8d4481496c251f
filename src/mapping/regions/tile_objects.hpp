// SPDX-License-Identifier: Apache-2.0
// What single tiles say of objects, read tile by tile: no scene is needed.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "mapping/map_reader.hpp"
#include "perception/clustering/tile_points.hpp"
#include "perception/features/ground_tile.hpp"

namespace cluxel::mapping {

/// By cluxel of a tile: the number in MapReader::objects(), or kNoObjectOfPoint. Throws Error (StoreUnavailable) for a
/// damaged map. Cost: 5 us.
std::vector<std::uint32_t> objectsInTile(const MapReader& map, const perception::TileKey& tile);

/// Of a cluxel's centre [m].
struct CluxelHeight {
  float z_map_m = 0, above_ground_m = 0;
};
/// By cluxel, in the order of MapReader::scene(). Throws as objectsInTile(). Cost: 100 ns a cluxel.
std::vector<CluxelHeight> heightsOfCluxels(const MapReader& map);

/// By object in the order of MapReader::objects(): how far it reaches above the local ground [m], as
/// ObjectGeometry::top_m. Throws as objectsInTile(). Cost: 100 ns a cluxel.
std::vector<double> topsOfObjects(const MapReader& map);

/// The ground of all tiles. Throws as objectsInTile(). Memory: 5 KB a tile.
std::map<perception::TileKey, perception::GroundTile> groundOfTiles(const MapReader& map);

/// A tile's thinned points, and the object of each: a number as in objectsInTile().
struct TileOfPoints {
  perception::TileKey key;
  const perception::TilePoints& points;
  std::vector<std::uint32_t> object;
};

/// Visits `tiles`, region by region, each once, in no order that means anything. At most `max_cluxels`, or a tile, are
/// in memory together. Throws as objectsInTile(). Cost: 150 ns a point.
void forEachTileOfPoints(const MapReader& map, const perception::TileSet& tiles,
                         const std::function<void(const TileOfPoints&)>& visit, std::size_t max_cluxels);

}  // namespace cluxel::mapping
