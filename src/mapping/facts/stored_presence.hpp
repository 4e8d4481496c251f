// SPDX-License-Identifier: Apache-2.0
// When objects were there, kept in the map: a change computes it anew only for objects that it reaches.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mapping/cloud.hpp"
#include "perception/segments/scene.hpp"
#include "perception/visibility/presence.hpp"
#include "rdf/file/environment.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

struct PresenceUpdate {
  std::vector<std::optional<perception::Presence>> presence;  ///< of each object
  std::size_t computed = 0;                                   ///< objects of which it was not known
};
/// When each object was there. Presence is a function of places on the object and of the clouds whose rays may pass it:
/// where both are those of the stored presence, that is taken. Stores the outcome.
PresenceUpdate updatePresence(rdf::WriteTransaction& transaction, const perception::Scene& scene,
                              std::span<const rules::SemanticObject> objects, const std::vector<Cloud>& clouds,
                              unsigned threads);

}  // namespace cluxel::mapping
