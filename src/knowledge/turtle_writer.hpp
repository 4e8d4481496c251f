// SPDX-License-Identifier: Apache-2.0
// Terms in Turtle: prefixed names where they are safe.
#pragma once

#include <string>

#include "cluxel/knowledge/rdf_io.hpp"

namespace cluxel {

/// Writes one term in Turtle so that every Turtle parser reads back the same term.
class TurtleTerms {
 public:
  explicit TurtleTerms(const RdfPrefixes& prefixes) : prefixes_(prefixes) {}
  std::string text(const Term& term) const;
  std::string header() const;

 private:
  std::string iri(const std::string& iri) const;
  const RdfPrefixes& prefixes_;
};

}  // namespace cluxel
