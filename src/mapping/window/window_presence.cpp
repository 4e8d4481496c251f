// SPDX-License-Identifier: Apache-2.0
// When clouds changed, objects that stay count too: rays of these clouds may pass them.
#include "mapping/window/window_presence.hpp"

#include <set>
#include <utility>

#include "mapping/facts/fact_patch.hpp"
#include "mapping/facts/fact_units.hpp"
#include "mapping/facts/object_facts.hpp"
#include "mapping/presence/object_presence.hpp"
#include "mapping/window/kept_objects.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

void tellPresence(rdf::WriteTransaction& transaction, std::span<const RayTarget> targets,
                  const std::vector<Cloud>& clouds, const std::set<ContentHash>& gone, unsigned threads) {
  const ObjectPresence presence = updatePresence(transaction, targets, Covered::Some, clouds, gone, threads);
  FactSink facts(transaction, rdf::vocabulary::kGraphObserved, FactsOf::Collected);
  const rdf::ReadTransaction& reading = transaction;
  const rdf::QuadReader stored(reading);
  FactPatch patch(stored, facts.iri(rdf::vocabulary::kGraphObserved));
  for (std::size_t i = 0; i < targets.size(); ++i)
    replaceRayFacts(facts.iri(rdf::iriOfObject(targets[i].object)), presence.times[i], presence.rays[i], patch, facts);
  patch.write(facts.take(), facts.writer());
  facts.writer().flush();
  forgetFactUnits(transaction);
}

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
  if (facts.has_other_rays || !areSame(facts.clouds_before, seenClouds(facts.clouds))) {
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
