// SPDX-License-Identifier: Apache-2.0
// The blocks of tiles and objects; faults of the file itself are told by rdf/file.
#include "mapping/damaged_map.hpp"

#include "cluxel/error.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

void refuseDamaged(const std::string& what) {
  throw Error(ErrorKind::StoreUnavailable, what + "; the map is damaged, build it anew");
}

void refuseIncompleteTile() {
  refuseDamaged("a stored tile lacks a block");
}

std::string_view requiredBlock(const rdf::ReadTransaction& transaction, std::string_view table,
                               const perception::TileKey& tile) {
  if (const auto bytes = transaction.block(table, tables::keyOf(tile))) return *bytes;
  refuseIncompleteTile();
}

}  // namespace cluxel::mapping
