// SPDX-License-Identifier: Apache-2.0
// A change that adds many tiles is decided strip by strip, so that its memory does not follow the change.
#pragma once

#include "mapping/window/local_update.hpp"

namespace cluxel::mapping {

/// After scans came, and nothing else changed. Absent, with nothing written, when the tiles that are new or have other
/// outputs have fewer cluxels than UpdateParams::whole_cluxels, or cannot be decided strip by strip. `changes` is then
/// as it was; else former summaries are gone from it.
std::optional<SemanticUpdate> updateByGrowth(const LayerWork& work, OutputChanges& changes);

}  // namespace cluxel::mapping
