// SPDX-License-Identifier: Apache-2.0
// The corner of tile (0, 0) as three numbers, the step of heights as one.
#include "mapping/stored_grid.hpp"

#include <array>
#include <cstring>
#include <string_view>

#include "mapping/damaged_map.hpp"
#include "mapping/map_tables.hpp"
#include "perception/clustering/local_steps.hpp"

namespace cluxel::mapping {

namespace {

using CornerNumbers = std::array<double, 3>;

template <typename Value>
std::string_view rawBytes(const Value& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

perception::TileGrid storedPlaceOfTiles(const rdf::ReadTransaction& transaction) {
  const auto bytes = transaction.block(tables::kMeta, tables::kGridKey);
  if (!bytes) return {};
  CornerNumbers corner{};
  if (bytes->size() != sizeof corner) refuseDamaged("where its tiles lie cannot be read");
  std::memcpy(corner.data(), bytes->data(), sizeof corner);
  for (const double value : corner)
    if (!(value <= 0 && value > -perception::kTileSize_m)) refuseDamaged("its tiles lie where they cannot");
  return perception::TileGrid::at({corner[0], corner[1], corner[2]});
}

}  // namespace

void storeGrid(rdf::WriteTransaction& transaction, const perception::TileGrid& grid) {
  if (grid.roundsHeights())
    transaction.putIfDifferent(tables::kMeta, tables::kHeightsKey, rawBytes(perception::kHeightStep_m));
  else
    transaction.eraseBlock(tables::kMeta, tables::kHeightsKey);
  if (grid.corner().isZero(0)) {
    transaction.eraseBlock(tables::kMeta, tables::kGridKey);
    return;
  }
  const CornerNumbers corner{grid.corner().x(), grid.corner().y(), grid.corner().z()};
  transaction.putIfDifferent(tables::kMeta, tables::kGridKey, rawBytes(corner));
}

perception::TileGrid storedGrid(const rdf::ReadTransaction& transaction) {
  const perception::TileGrid grid = storedPlaceOfTiles(transaction);
  const auto step = transaction.block(tables::kMeta, tables::kHeightsKey);
  if (!step) return grid.withHeightsAsMeasured();
  if (*step != rawBytes(perception::kHeightStep_m)) refuseDamaged("the step of its heights cannot be read");
  return grid;
}

}  // namespace cluxel::mapping
