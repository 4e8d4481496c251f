// SPDX-License-Identifier: Apache-2.0
// From a literal's lexical form to its value.
#pragma once

#include <string_view>

#include "cluxel/knowledge/quad_store.hpp"

namespace cluxel {

/// The value of a literal with this datatype IRI; type None when the form is not of the datatype, the value
/// does not fit, or the datatype is not one of those of DecodedValue::Type. The lexical space of XML
/// Schema 1.1 part 2, without surrounding blanks (RDF 1.1 concepts, 5).
DecodedValue decodeLiteral(std::string_view lexical, std::string_view datatype);

/// Gives the value of an xsd:decimal its exact digits, where they are few enough.
void addExactDigits(std::string_view lexical, DecodedValue& value);

}  // namespace cluxel
