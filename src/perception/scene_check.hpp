// SPDX-License-Identifier: Apache-2.0
// Whether stored blocks, each sound by itself, belong together.
#pragma once

#include "cluxel/perception/scene_assembly.hpp"

namespace cluxel {

/// Throws Error (StoreUnavailable) where blocks of a tile, or of neighbours, speak of things that the others do not
/// have.
void checkFit(const SceneTiles& tiles);

}  // namespace cluxel
