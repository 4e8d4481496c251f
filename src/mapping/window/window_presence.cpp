// SPDX-License-Identifier: Apache-2.0
// When clouds changed, objects that stay count too: rays of these clouds may pass them.
#include "mapping/window/window_presence.hpp"

#include <set>
#include <utility>

#include "mapping/presence/object_presence.hpp"
#include "mapping/window/kept_objects.hpp"

namespace cluxel::mapping {

WindowPresence updatePresenceIn(rdf::WriteTransaction& transaction, const WindowFacts& facts,
                                const std::vector<rules::SemanticObject>& made) {
  const perception::Scene& scene = facts.decided.window.scene;
  std::set<ContentHash> former = facts.retired.objects;
  for (const auto& [id, record] : facts.decided.decision.replaced) former.insert(id);
  WindowPresence result;
  result.times.resize(made.size()), result.rays.resize(made.size());
  if (facts.later != nullptr) {
    facts.later->remove(former);
    facts.later->add(rayTargets(scene, made, facts.parsed.rules));
    return result;
  }
  std::vector<rules::SemanticObject> asked = made;
  if (!areSame(facts.clouds_before, seenClouds(facts.clouds))) {
    const auto kept = keptObjects(transaction, facts.decided.window, facts.decided.decision, facts.decided.former);
    asked.insert(asked.end(), kept.begin(), kept.end());
  }
  ObjectPresence presence = updatePresence(transaction, rayTargets(scene, asked, facts.parsed.rules), Covered::Some,
                                           facts.clouds, former, facts.threads);
  for (std::size_t i = made.size(); i < asked.size(); ++i)
    result.kept.push_back({asked[i].id, presence.times[i], presence.rays[i]});
  result.times = std::move(presence.times), result.rays = std::move(presence.rays);
  result.times.resize(made.size()), result.rays.resize(made.size());
  return result;
}

}  // namespace cluxel::mapping
