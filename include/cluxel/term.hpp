// SPDX-License-Identifier: Apache-2.0
// RDF 1.1 terms and quads as values.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "cluxel/export.hpp"

namespace cluxel {

enum class TermKind : std::uint8_t { Iri, BlankNode, Literal };

/// An IRI, a blank node or a literal. A plain literal has the datatype xsd:string, a language-tagged one
/// rdf:langString; language tags are kept in lower case.
struct CLUXEL_API Term {
  TermKind kind = TermKind::Iri;
  std::string text;      ///< the IRI, the blank node's label, or the lexical form
  std::string datatype;  ///< the datatype IRI of a literal, else empty
  std::string language;  ///< the language tag of a literal, else empty

  auto operator<=>(const Term&) const = default;

  static Term iri(std::string_view value) { return {TermKind::Iri, std::string(value), {}, {}}; }
  static Term blank(std::string_view label) { return {TermKind::BlankNode, std::string(label), {}, {}}; }
  static Term literal(std::string_view lexical);  ///< xsd:string
  static Term literal(std::string_view lexical, std::string_view datatype);
  static Term langLiteral(std::string_view lexical, std::string_view language);
  static Term integer(std::int64_t value);
  static Term real(double value);  ///< xsd:double, shortest canonical form that reads back the same
  static Term boolean(bool value);
};

/// One statement; the unnamed default graph is a graph term with an empty IRI.
struct Quad {
  Term subject, predicate, object;
  Term graph;

  auto operator<=>(const Quad&) const = default;
};

/// N-Triples form with the canonical escapes of RDF 1.1 N-Triples.
CLUXEL_API std::string toNTriples(const Term& term);
/// One canonical N-Quads line, with " .\n"; the default graph is left out.
CLUXEL_API std::string toNQuads(const Quad& quad);

}  // namespace cluxel
