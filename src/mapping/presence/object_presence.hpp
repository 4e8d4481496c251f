// SPDX-License-Identifier: Apache-2.0
// What rays tell of some objects of a map.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "mapping/clouds/cloud.hpp"
#include "perception/segments/scene.hpp"
#include "perception/visibility/presence.hpp"
#include "perception/visibility/ray_bundle.hpp"
#include "rdf/file/environment.hpp"
#include "rules/language/rule_set.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// By object.
struct ObjectPresence {
  std::vector<std::optional<perception::Presence>> times;
  std::vector<std::optional<perception::RayCounts>> rays;
};

/// Computes and stores when objects were there, and how many rays passed the barriers among them, from the rays of all
/// clouds of the map. Of `gone` only the rows of those stay that are among `objects`. Cost: as for PassedRaysUpdate.
ObjectPresence updatePresence(rdf::WriteTransaction& transaction, const rules::RuleSet& rules,
                              const perception::Scene& scene, const std::vector<rules::SemanticObject>& objects,
                              const std::vector<Cloud>& clouds, const std::set<ContentHash>& gone, unsigned threads);

}  // namespace cluxel::mapping
