// SPDX-License-Identifier: Apache-2.0
// Where the tiles of a stored map lie, and how local heights are rounded.
#pragma once

#include "perception/tile.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Comes before the first scan is stored. Where the tiles lie is stored unless the origin lies at whole tiles; the step
/// of local heights, unless they are as measured.
void storeGrid(rdf::WriteTransaction& transaction, const perception::TileGrid& grid);
/// Earlier versions had tiles at whole multiples of their size in the map frame, and heights as measured, and stored
/// neither. So their maps are read as they were written. Throws Error (StoreUnavailable) when it is damaged.
perception::TileGrid storedGrid(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
