// SPDX-License-Identifier: Apache-2.0
// Strips write objects without facts from rays. These facts are added here.
#include "mapping/strips/strip_presence.hpp"

#include "mapping/clouds/scan_store.hpp"
#include "mapping/facts/fact_patch.hpp"
#include "mapping/facts/fact_units.hpp"
#include "mapping/facts/object_facts.hpp"
#include "mapping/presence/object_presence.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

void tellPresence(const LayerWork& work, LaterTargets& targets) {
  if (work.check) work.check(0);
  const std::vector<RayTarget> told = targets.take();
  const ObjectPresence presence = updatePresence(work.transaction, told, Covered::Some, storedClouds(work.transaction),
                                                 targets.removed(), work.params.threads);
  FactSink facts(work.transaction, rdf::vocabulary::kGraphObserved, FactsOf::Collected);
  const rdf::ReadTransaction& reading = work.transaction;
  const rdf::QuadReader stored(reading);
  FactPatch patch(stored, facts.iri(rdf::vocabulary::kGraphObserved));
  for (std::size_t i = 0; i < told.size(); ++i)
    replaceRayFacts(facts.iri(rdf::iriOfObject(told[i].object)), presence.times[i], presence.rays[i], patch, facts);
  patch.write(facts.take(), facts.writer());
  facts.writer().flush();
  forgetFactUnits(work.transaction);
}

}  // namespace cluxel::mapping
