// SPDX-License-Identifier: Apache-2.0
// When clouds changed, objects that stay count too: rays of these clouds may pass them.
#include "mapping/window/window_presence.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "mapping/build/scan_store.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/presence/passed_rays.hpp"
#include "mapping/presence/stored_presence.hpp"
#include "mapping/window/kept_objects.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

WindowPresence updatePresenceIn(rdf::WriteTransaction& transaction, const WindowFacts& facts,
                                const std::vector<rules::SemanticObject>& made) {
  const perception::Scene& scene = facts.decided.window.scene;
  std::vector<rules::SemanticObject> asked = made;
  if (!areSame(facts.clouds_before, seenClouds(facts.clouds))) {
    const auto kept = keptObjects(transaction, facts.decided.window, facts.decided.decision, facts.decided.former);
    asked.insert(asked.end(), kept.begin(), kept.end());
  }
  const auto counts_rays = [&](const rules::SemanticObject& object) {
    return facts.parsed.rules.catalogue.isA(object.class_iri, rdf::vocabulary::clx("Barrier"));
  };
  PresenceUpdate presence(transaction, scene, asked, facts.clouds, facts.threads);
  PassedRaysUpdate rays(transaction, scene, asked, facts.clouds, counts_rays, facts.threads);
  std::vector<RayObserver*> observers{&rays};
  if (presence.observer() != nullptr) observers.push_back(presence.observer());
  passRays(facts.clouds, observers, [&](const Cloud& cloud) { return storedScan(transaction, cloud.id); });
  std::set<ContentHash> former = facts.retired.objects;
  for (const auto& [id, record] : facts.decided.decision.replaced) former.insert(id);
  for (const ContentHash& id : former)
    for (const std::string_view table : {tables::kPresence, tables::kPassedRays})
      transaction.eraseBlock(table, tables::keyOf(id));
  WindowPresence result{presence.finish(transaction, Covered::Some), rays.finish(transaction, Covered::Some), {}};
  for (std::size_t i = made.size(); i < asked.size(); ++i)
    result.kept.push_back({asked[i].id, i < result.times.size() ? result.times[i] : std::nullopt, result.rays[i]});
  if (!result.times.empty()) result.times.resize(made.size());
  result.rays.resize(made.size());
  return result;
}

}  // namespace cluxel::mapping
