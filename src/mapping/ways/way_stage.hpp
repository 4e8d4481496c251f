// SPDX-License-Identifier: Apache-2.0
// The two stages of ways in a tile: its surface of even ground, and what it contributes to the map's ways. Each follows
// from outputs of the tile and its eight neighbours.
#pragma once

#include <map>

#include "mapping/ways/even_ground.hpp"
#include "mapping/ways/way_tile.hpp"

namespace cluxel::mapping {

/// `wanted` and `context` ascend; `context` holds `wanted` and those of its neighbours that the map has. Cost: about
/// 0.5 ms a tile of the context.
std::map<perception::TileKey, SurfaceTile> surfaceTilesOf(const perception::TileSet& wanted,
                                                          const perception::TileSet& context,
                                                          const EvenTileSource& tileAt);
std::map<perception::TileKey, WayTile> wayTilesOf(const perception::TileSet& wanted, const perception::TileSet& context,
                                                  const EvenTileSource& tileAt, const SurfaceTileSource& surfaceAt);

}  // namespace cluxel::mapping
