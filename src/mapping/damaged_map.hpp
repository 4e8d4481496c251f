// SPDX-License-Identifier: Apache-2.0
// What is said when stored blocks do not fit together.
#pragma once

#include <string>
#include <string_view>

#include "perception/tile.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Throws Error (StoreUnavailable): "WHAT; the map is damaged, build it anew".
[[noreturn]] void refuseDamaged(const std::string& what);
/// A stored tile lacks a block.
[[noreturn]] void refuseIncompleteTile();
/// The block of a tile in a table. Throws as refuseIncompleteTile() when it is absent.
std::string_view requiredBlock(const rdf::ReadTransaction& transaction, std::string_view table,
                               const perception::TileKey& tile);
/// A block names its tile: refuses that of another one.
template <typename Tile>
Tile ofTile(const perception::TileKey& key, Tile tile) {
  if (tile.key == key) return tile;
  refuseDamaged("a stored tile has the block of another");
}

}  // namespace cluxel::mapping
