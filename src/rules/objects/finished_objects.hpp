// SPDX-License-Identifier: Apache-2.0
// The objects made so far, as values.
#pragma once

#include <vector>

#include "rules/decide/reasoning_state.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::rules {

/// The name of the object that takes in all of a class: it stays when the map grows.
ContentHash idOfClassWide(const std::string& class_iri);
/// Hash of the class and of the members' seed points: independent of everything else in the scene. A class-wide object
/// is named by its class.
ContentHash idOf(const perception::Scene& scene, const SemanticObject& object);

/// Objects that own at least one cluxel, sorted by id.
std::vector<SemanticObject> finishedObjects(const ReasoningState& state);

}  // namespace cluxel::rules
