// SPDX-License-Identifier: Apache-2.0
// Which present object an IRI means.
#pragma once

#include <optional>
#include <string>

#include "mapping/change/map_things.hpp"
#include "mapping/things/ended_names.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

class KnownObjects {
 public:
  explicit KnownObjects(const rdf::ReadTransaction& transaction);

  /// The object of this IRI, or the one that continues this thing or former object.
  std::optional<ContentHash> find(const std::string& iri) const;
  /// What became of a name that the map had and that leads to no object, or to several.
  std::optional<EndedName> endOf(const std::string& iri) const;

 private:
  const rdf::ReadTransaction& transaction_;
  Lineage lineage_;
};

}  // namespace cluxel::mapping
