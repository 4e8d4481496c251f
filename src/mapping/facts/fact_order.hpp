// SPDX-License-Identifier: Apache-2.0
// The order in which facts are given to a map. Terms get their ids in this order, so that facts about things that lie
// near each other lie on the same pages of the indexes: a change of one place then writes few pages.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "perception/segments/scene.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// All primitives of a scene, tile by tile along a curve (perception::mortonCode()).
std::vector<perception::PrimitiveIndex> primitivesByPlace(const perception::Scene& scene);
/// Numbers of objects, by the first tile on the curve that holds the centroid of a primitive of theirs.
std::vector<std::size_t> objectsByPlace(const perception::Scene& scene, std::span<const rules::SemanticObject> objects);

}  // namespace cluxel::mapping
