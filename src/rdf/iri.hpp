// SPDX-License-Identifier: Apache-2.0
// Which characters an IRI may hold.
#pragma once

#include <algorithm>
#include <string_view>

namespace cluxel::rdf {

/// The characters that the rule IRIREF of SPARQL and Turtle forbids between < and >.
constexpr bool isForbiddenInIri(char c) {
  constexpr std::string_view forbidden = "<>\"{}|^`\\";
  return static_cast<unsigned char>(c) <= 0x20 || forbidden.find(c) != std::string_view::npos;
}

constexpr bool hasIriCharactersOnly(std::string_view iri) {
  return std::none_of(iri.begin(), iri.end(), isForbiddenInIri);
}

}  // namespace cluxel::rdf
