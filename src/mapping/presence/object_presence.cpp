// SPDX-License-Identifier: Apache-2.0
// Stored rows are looked at before any is erased: an object may be gone and come again.
#include "mapping/presence/object_presence.hpp"

#include "mapping/clouds/scan_store.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/presence/passed_rays.hpp"
#include "mapping/presence/stored_presence.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

ObjectPresence updatePresence(rdf::WriteTransaction& transaction, const rules::RuleSet& rules,
                              const perception::Scene& scene, const std::vector<rules::SemanticObject>& objects,
                              const std::vector<Cloud>& clouds, const std::set<ContentHash>& gone, unsigned threads) {
  const auto counts_rays = [&](const rules::SemanticObject& object) {
    return rules.catalogue.isA(object.class_iri, rdf::vocabulary::clx("Barrier"));
  };
  PresenceUpdate presence(transaction, scene, objects, clouds, threads);
  PassedRaysUpdate rays(transaction, scene, objects, clouds, counts_rays, threads);
  std::vector<RayObserver*> observers{&rays};
  if (presence.observer() != nullptr) observers.push_back(presence.observer());
  passRays(clouds, observers, [&](const Cloud& cloud) { return storedScan(transaction, cloud.id); });
  for (const ContentHash& id : gone)
    for (const std::string_view table : {tables::kPresence, tables::kPassedRays})
      transaction.eraseBlock(table, tables::keyOf(id));
  return {presence.finish(transaction, Covered::Some), rays.finish(transaction, Covered::Some)};
}

}  // namespace cluxel::mapping
