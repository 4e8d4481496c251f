// SPDX-License-Identifier: Apache-2.0
// A row is the keys of its tiles, one after the other.
#include "mapping/statements/statement_places.hpp"

#include <algorithm>

#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

constexpr std::size_t kTileKeyBytes = 8;

/// Those of `map` that come near the rectangle around the corners.
perception::TileSet tilesAround(const std::vector<Eigen::Vector2d>& corners, const perception::TileGrid& grid,
                                const perception::TileSet& map) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : corners) box.extend(corner);
  perception::TileSet tiles;
  for (const perception::TileKey& tile : map) {
    const Eigen::Vector2d low = grid.cornerOf(tile).head<2>();
    if (box.intersects({low, Eigen::Vector2d(low.array() + perception::kTileSize_m)})) tiles.insert(tile);
  }
  return tiles;
}

}  // namespace

std::vector<Eigen::Vector2d> cornersOf(const RegionAnchor& region, const std::vector<Cloud>& clouds) {
  const auto cloud =
      std::find_if(clouds.begin(), clouds.end(), [&](const Cloud& known) { return known.id == region.scan; });
  std::vector<Eigen::Vector2d> corners;
  if (cloud == clouds.end()) return corners;
  for (const Eigen::Vector3d& corner : region.corners) corners.emplace_back((cloud->T_map_sensor * corner).head<2>());
  return corners;
}

perception::TileSet tilesOf(const Statement& statement, PointOwners& owners, const std::vector<Cloud>& clouds,
                            const perception::TileSet& map) {
  if (statement.kind == StatementKind::IgnoreRegion)
    return tilesAround(cornersOf(statement.region, clouds), owners.grid(), map);
  return owners.tilesOf(statement.points);
}

StatementTiles storedStatementTiles(const rdf::ReadTransaction& transaction) {
  StatementTiles all;
  transaction.forEachBlock(tables::kStated, "", [&](std::string_view key, std::string_view bytes) {
    perception::TileSet& tiles = all[tables::hashOfKey(key)];
    for (std::size_t at = 0; at + kTileKeyBytes <= bytes.size(); at += kTileKeyBytes)
      tiles.insert(tables::tileOfKey(bytes.substr(at, kTileKeyBytes)));
  });
  return all;
}

void storeStatementTiles(rdf::WriteTransaction& transaction, const StatementTiles& tiles) {
  const StatementTiles before = storedStatementTiles(transaction);
  for (const auto& [statement, old] : before)
    if (!tiles.contains(statement)) transaction.eraseBlock(tables::kStated, tables::keyOf(statement));
  for (const auto& [statement, now] : tiles) {
    if (const auto old = before.find(statement); old != before.end() && old->second == now) continue;
    std::string bytes;
    for (const perception::TileKey& tile : now) bytes += tables::keyOf(tile);
    transaction.putBlock(tables::kStated, tables::keyOf(statement), bytes);
  }
}

}  // namespace cluxel::mapping
