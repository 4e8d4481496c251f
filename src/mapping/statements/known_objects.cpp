// SPDX-License-Identifier: Apache-2.0
// Objects that there are come first: their names need no history.
#include "mapping/statements/known_objects.hpp"

#include "mapping/layers/stored_layers.hpp"

namespace cluxel::mapping {

KnownObjects::KnownObjects(const rdf::ReadTransaction& transaction)
    : transaction_(transaction), lineage_(rdf::QuadReader(transaction), storedObjectIds(transaction)) {}

std::optional<ContentHash> KnownObjects::find(const std::string& iri) const {
  const std::optional<ContentHash> object = hashIn(iri, "object");
  if (object && storedRecord(transaction_, *object)) return object;
  const auto former = lineage_.find(iri);
  return former ? std::optional(former->object) : std::nullopt;
}

std::optional<EndedName> KnownObjects::endOf(const std::string& iri) const {
  const auto isPresent = [&](const ContentHash& object) { return storedRecord(transaction_, object).has_value(); };
  return mapping::endOf(rdf::QuadReader(transaction_), isPresent, iri);
}

}  // namespace cluxel::mapping
