// SPDX-License-Identifier: Apache-2.0
// Whether outputs of tiles belong together, where all of a map's tiles or some of them are held.
#pragma once

#include <array>

#include "perception/segments/scene_assembly.hpp"
#include "perception/tile.hpp"

namespace cluxel::perception {

/// For each tile of the ring whether it is one of `tiles`.
std::array<bool, 9> ringAmong(const TileSet& tiles, const TileKey& key);

/// Throws Error (StoreUnavailable) when the outputs of a tile and its neighbours contradict each other. `elsewhere`:
/// tiles that are not held.
void checkFit(const TileOutputs& tiles, const TileSet& elsewhere);

}  // namespace cluxel::perception
