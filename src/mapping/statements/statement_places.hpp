// SPDX-License-Identifier: Apache-2.0
// The tiles that each statement is about, kept so that a change tells which statements it concerns.
#pragma once

#include <map>
#include <vector>

#include "mapping/statements/point_owners.hpp"
#include "mapping/statements/statement.hpp"
#include "perception/tile.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

using StatementTiles = std::map<ContentHash, perception::TileSet>;  ///< by the statement's id

/// The tiles of the points, whether the map has them or not, or those of `map` at the rectangle around the region.
perception::TileSet tilesOf(const Statement& statement, PointOwners& owners, const std::vector<Cloud>& clouds,
                            const perception::TileSet& map);

/// The corners of a region in the map frame; empty when the map lacks its scan.
std::vector<Eigen::Vector2d> cornersOf(const RegionAnchor& region, const std::vector<Cloud>& clouds);

StatementTiles storedStatementTiles(const rdf::ReadTransaction& transaction);
/// Writes the rows that differ. Makes the map hold these rows and no others.
void storeStatementTiles(rdf::WriteTransaction& transaction, const StatementTiles& tiles);

}  // namespace cluxel::mapping
