// SPDX-License-Identifier: Apache-2.0
// What a map stores of an object beside its cluxels, which lie in the layers of tiles.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "perception/tile.hpp"

namespace cluxel::mapping {

struct ObjectRecord {
  std::string class_iri, rule_id;
  double confidence = 0;
  bool is_class_wide = false;              ///< as SemanticObject::is_class_wide
  std::vector<perception::TileKey> tiles;  ///< those with cluxels of it, ascending
};

std::string toBytes(const ObjectRecord& record);
/// Throws Error (StoreUnavailable) when the bytes are damaged or of another kind.
ObjectRecord objectRecordFromBytes(std::string_view bytes);

}  // namespace cluxel::mapping
