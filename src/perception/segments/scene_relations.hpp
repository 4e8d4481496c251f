// SPDX-License-Identifier: Apache-2.0
// Relations between primitives from the contacts of their components.
#pragma once

#include <map>
#include <vector>

#include "perception/segments/contact_tile.hpp"
#include "perception/segments/scene.hpp"
#include "perception/segments/scene_assembly.hpp"

namespace cluxel::perception {

/// The sum of all contacts between the components of two primitives.
struct PrimitiveContact {
  PrimitiveIndex from = 0, to = 0;
  std::uint64_t edges = 0, overlaps = 0;
  double height_difference = 0;  ///< summed over overlaps [m]
  double gap = 0;                ///< [m]
};

/// Appends the relations that follow from `contacts`, and touches_ground of every primitive.
void appendRelations(const std::vector<PrimitiveContact>& contacts, const RelationParams& params, Scene& scene);

}  // namespace cluxel::perception
