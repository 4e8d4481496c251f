// SPDX-License-Identifier: Apache-2.0
// A part of a scene that holds some of its primitives as they are.
#pragma once

#include <span>

#include "perception/segments/scene.hpp"

namespace cluxel::perception {

/// The scene of `kept` (ascending) with their cluxels, the edges and the relations among them. Ids and attributes stay;
/// numbers of primitives and cluxels are new ones in the same order. Cost O(n) in the cluxels of the whole scene.
Scene partOf(const Scene& scene, std::span<const PrimitiveIndex> kept);

}  // namespace cluxel::perception
