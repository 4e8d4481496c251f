// SPDX-License-Identifier: Apache-2.0
// Writes terms in Turtle, as prefixed names where possible.
#pragma once

#include <string>

#include "rdf/io/rdf_io.hpp"

namespace cluxel::rdf {

/// Writes terms that every Turtle parser reads back unchanged.
class TurtleTerms {
 public:
  explicit TurtleTerms(const RdfPrefixes& prefixes) : prefixes_(prefixes) {}
  std::string text(const Term& term) const;
  std::string header() const;

 private:
  std::string iri(const std::string& iri) const;
  const RdfPrefixes& prefixes_;
};

}  // namespace cluxel::rdf
