// SPDX-License-Identifier: Apache-2.0
// Follows primitives from tile to tile by what the map has stored of them.
#pragma once

#include <functional>
#include <map>
#include <set>

#include "base/content_hash.hpp"
#include "perception/tile.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Reads each layer of a tile once, however many primitives are followed.
class PrimitiveTiles {
 public:
  explicit PrimitiveTiles(const rdf::ReadTransaction& transaction) : transaction_(transaction) {}

  using IsLeftOut = std::function<bool(const perception::TileKey& tile)>;
  /// The tiles beyond `from` that hold one of the primitives and are joined to `from` by such tiles. Tiles that are
  /// left out are not looked at. Cost: reads the layers of these tiles and of those next to them.
  perception::TileSet beyond(const perception::TileSet& from, const std::set<ContentHash>& primitives,
                             const IsLeftOut& is_left_out = {});

 private:
  const std::set<ContentHash>& primitivesIn(const perception::TileKey& tile);

  const rdf::ReadTransaction& transaction_;
  std::map<perception::TileKey, std::set<ContentHash>> known_;
};

}  // namespace cluxel::mapping
