// SPDX-License-Identifier: Apache-2.0
// Decodes the lexical form of a literal to its value.
#pragma once

#include <string_view>

#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// The value of a literal with this datatype IRI, by the lexical spaces of XML Schema 1.1 part 2 without surrounding
/// white space (RDF 1.1 Concepts, section 5). Type None when the literal is ill-typed, its value does not fit, or the
/// datatype is not one of DecodedValue::Type.
DecodedValue decodeLiteral(std::string_view lexical, std::string_view datatype);

/// Stores the exact digits of an xsd:decimal if there are at most 18.
void addExactDigits(std::string_view lexical, DecodedValue& value);

}  // namespace cluxel::rdf
