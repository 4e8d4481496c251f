// SPDX-License-Identifier: Apache-2.0
// Stored rows are looked at before any is erased: an object may be gone and come again.
#include "mapping/presence/object_presence.hpp"

#include "mapping/clouds/scan_store.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/presence/passed_rays.hpp"
#include "mapping/presence/stored_presence.hpp"

namespace cluxel::mapping {

ObjectPresence updatePresence(rdf::WriteTransaction& transaction, std::span<const RayTarget> targets, Covered covered,
                              const std::vector<Cloud>& clouds, const std::set<ContentHash>& gone, unsigned threads) {
  PresenceUpdate presence(transaction, targets, clouds, threads);
  PassedRaysUpdate rays(transaction, targets, clouds, threads);
  std::vector<RayObserver*> observers{&rays};
  if (presence.observer() != nullptr) observers.push_back(presence.observer());
  passRays(clouds, observers, [&](const Cloud& cloud) { return storedScan(transaction, cloud.id); });
  for (const ContentHash& id : gone)
    for (const std::string_view table : {tables::kPresence, tables::kPassedRays})
      transaction.eraseBlock(table, tables::keyOf(id));
  return {presence.finish(transaction, covered), rays.finish(transaction, covered)};
}

}  // namespace cluxel::mapping
