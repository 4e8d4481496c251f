// SPDX-License-Identifier: Apache-2.0
// The characters, the path and the local name of IRIs.
#pragma once

#include <algorithm>
#include <string>
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

/// False when resolution by RFC 3986 cannot change the path of an absolute IRI: it holds no segment "." or "..".
inline bool mayHoldDotSegments(std::string_view iri) {
  return iri.find("/./") != std::string_view::npos || iri.find("/../") != std::string_view::npos ||
         iri.ends_with("/.") || iri.ends_with("/..");
}

/// "Tree" of "https://w3id.org/cluxel/ontology#Tree": what follows the last '#' or '/'.
inline std::string localName(std::string_view iri) {
  return std::string(iri.substr(iri.find_last_of("#/") + 1));
}

/// All up to the last '#' or '/'; of an IRI with neither ("urn:x:Tree"), up to the last ':'.
inline std::string namespaceOf(std::string_view iri) {
  const std::size_t end = iri.find_last_of("#/");
  return std::string(iri.substr(0, (end != std::string_view::npos ? end : iri.rfind(':')) + 1));
}

}  // namespace cluxel::rdf
