// SPDX-License-Identifier: Apache-2.0
// Reads the ground of the tiles around each tile that holds places.
#include "mapping/regions/ground_heights.hpp"

#include <algorithm>
#include <map>

#include "mapping/damaged_map.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/stored_grid.hpp"
#include "perception/features/ground_tile.hpp"
#include "perception/tile_borders.hpp"

namespace cluxel::mapping {

namespace {

using perception::GroundTile;
using perception::kTileSize_m;
using perception::TileKey;

/// The ground of the tile itself and of those around it that are there.
std::map<TileKey, GroundTile> groundAround(const MapReader& map, const TileKey& key) {
  std::map<TileKey, GroundTile> ground;
  for (const TileKey& tile : perception::ringOf(key))
    if (const auto bytes = map.transaction().block(tables::kGround, tables::keyOf(tile)))
      ground.emplace(tile, ofTile(tile, perception::groundTileFromBytes(perception::withoutBorders(*bytes))));
  return ground;
}

double distanceTo(const Eigen::Vector3d& corner, const Eigen::Vector2d& place) {
  const Eigen::Vector2d local = place - corner.head(2);
  return (local - local.cwiseMax(0.0).cwiseMin(kTileSize_m)).norm();
}

double heightAt(const std::map<TileKey, GroundTile>& ground, const perception::TileGrid& grid,
                const Eigen::Vector2d& place) {
  const auto nearest = std::min_element(ground.begin(), ground.end(), [&](const auto& a, const auto& b) {
    return distanceTo(grid.cornerOf(a.first), place) < distanceTo(grid.cornerOf(b.first), place);
  });
  const Eigen::Vector3d corner = grid.cornerOf(nearest->first);
  const Eigen::Vector2d local = place - corner.head<2>();
  return corner.z() + groundHeightAt(ringIn(ground, nearest->first), local.x(), local.y());
}

}  // namespace

std::vector<std::optional<double>> groundHeightsAt(const MapReader& map, std::span<const Eigen::Vector2d> places) {
  const perception::TileGrid grid = storedGrid(map.transaction());
  std::map<TileKey, std::vector<std::size_t>> in_tile;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i].cwiseAbs().maxCoeff() <= scan::kMaxCoordinate_m)
      in_tile[grid.tileOf({places[i].x(), places[i].y(), 0})].push_back(i);
  std::vector<std::optional<double>> heights(places.size());
  for (const auto& [tile, here] : in_tile) {
    const std::map<TileKey, GroundTile> ground = groundAround(map, tile);
    for (const std::size_t i : here)
      if (!ground.empty()) heights[i] = heightAt(ground, grid, places[i]);
  }
  return heights;
}

}  // namespace cluxel::mapping
