// SPDX-License-Identifier: Apache-2.0
// Relations between primitives from the contacts of their components.
#pragma once

#include <map>
#include <vector>

#include "cluxel/perception/contact_tile.hpp"
#include "cluxel/perception/scene.hpp"
#include "cluxel/perception/scene_assembly.hpp"

namespace cluxel {

/// What all contacts between the components of two primitives add up to.
struct PrimitiveContact {
  PrimitiveIndex from = 0, to = 0;
  std::uint64_t edges = 0, overlaps = 0;
  double height_difference = 0;  ///< summed over overlaps [m]
  double gap = 0;                ///< [m]
};

/// Appends the relations that follow from `contacts`, and touches_ground of every primitive.
void appendRelations(const std::vector<PrimitiveContact>& contacts, const RelationParams& params, Scene& scene);

}  // namespace cluxel
