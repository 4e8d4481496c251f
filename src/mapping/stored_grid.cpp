// SPDX-License-Identifier: Apache-2.0
// The corner of tile (0, 0) as three numbers.
#include "mapping/stored_grid.hpp"

#include <array>
#include <cmath>
#include <cstring>

#include "mapping/damaged_map.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

using Numbers = std::array<double, 3>;

}  // namespace

void storeGrid(rdf::WriteTransaction& transaction, const perception::TileGrid& grid) {
  if (grid == perception::TileGrid()) {
    transaction.eraseBlock(tables::kMeta, tables::kGridKey);
    return;
  }
  const Numbers corner{grid.corner().x(), grid.corner().y(), grid.corner().z()};
  transaction.putIfDifferent(tables::kMeta, tables::kGridKey,
                             {reinterpret_cast<const char*>(corner.data()), sizeof corner});
}

perception::TileGrid storedGrid(const rdf::ReadTransaction& transaction) {
  const auto bytes = transaction.block(tables::kMeta, tables::kGridKey);
  if (!bytes) return {};
  Numbers corner{};
  if (bytes->size() != sizeof corner) refuseDamaged("where its tiles lie cannot be read");
  std::memcpy(corner.data(), bytes->data(), sizeof corner);
  for (const double value : corner)
    if (!(value <= 0 && value > -perception::kTileSize_m)) refuseDamaged("its tiles lie where they cannot");
  return perception::TileGrid::at({corner[0], corner[1], corner[2]});
}

}  // namespace cluxel::mapping
