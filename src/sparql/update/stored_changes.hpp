// SPDX-License-Identifier: Apache-2.0
// Removals and insertions of one operation of an update, applied to the store and counted.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rdf/store/quad_store.hpp"
#include "sparql/update/update_modify.hpp"

namespace cluxel::sparql {

struct ChangeCounts {
  std::uint64_t inserted = 0, deleted = 0;  ///< quads by which the store differs
};

/// Writes and flushes the changes. A quad that is removed and inserted stays. The reader must see the state of the
/// writer's last flush.
ChangeCounts applyChanges(const rdf::QuadReader& reader, rdf::QuadWriter& writer, const Changes& changes, Guard& guard);

/// The removals that name no graph and whose triples lie in graphs that may not be written: after the removal from the
/// default graph the union would still hold them.
struct LockedTriples {
  std::size_t count = 0, of = 0;  ///< of all removals
  Quad first;                     ///< with the graph that holds it
};
std::optional<LockedTriples> lockedTriples(const rdf::QuadReader& reader, std::span<const ChangedQuad> removals,
                                           const std::vector<std::string>& writable_graphs, Guard& guard);

}  // namespace cluxel::sparql
