// SPDX-License-Identifier: Apache-2.0
// What rays tell of the objects of all strips.
#pragma once

#include "mapping/window/local_update.hpp"

namespace cluxel::mapping {

/// Computes and tells when the objects that strips have made were there, and how many rays passed the barriers among
/// them. Each scan is read once; strip by strip it would be read as often as its rays reach another strip.
void tellPresence(const LayerWork& work, LaterTargets& targets);

}  // namespace cluxel::mapping
