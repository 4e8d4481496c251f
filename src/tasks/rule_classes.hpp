// SPDX-License-Identifier: Apache-2.0
// Which classes a SPARQL rule can give, as its text tells.
#pragma once

#include <set>
#include <string>

#include "mapping/map_inputs.hpp"

namespace cluxel::tasks {

/// What a rule can make the object of rdf:type.
struct GivenClasses {
  std::set<std::string> named;  ///< IRIs that the rule names for it, in CONSTRUCT, BIND, SELECT or VALUES
  bool is_open = false;         ///< it takes classes from the map, or computes them or the property
};

/// Throws InputError when the rule cannot be parsed. Cost: that of parsing it, and of its length for each variable that
/// holds a class.
GivenClasses classesGivenBy(const mapping::NamedText& rule);

}  // namespace cluxel::tasks
