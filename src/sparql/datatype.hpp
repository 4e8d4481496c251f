// SPDX-License-Identifier: Apache-2.0
// The datatypes whose values are known, with the ranges of the integer types.
#pragma once

#include <string_view>

#include "sparql/value.hpp"

namespace cluxel::sparql {

struct DatatypeInfo {
  std::string_view local;  ///< after the xsd namespace
  Value::Type type = Value::Type::Other;
  CalendarKind calendar = CalendarKind::DateTime;
  std::string_view least = {}, greatest = {};  ///< of the integer types; empty: no bound

  bool inRange(const Decimal& value) const;
};

/// Null for a datatype that is not known.
const DatatypeInfo* findDatatype(std::string_view iri);

/// The datatype IRI of a computed literal; empty for IRIs, blank nodes and errors.
std::string_view datatypeIri(const Value& value);

/// The type that literals of a datatype have when they are well-formed; Other for unknown datatypes.
Value::Type valueTypeOfDatatype(std::string_view iri);

DurationKind durationKind(Value::Type type);

}  // namespace cluxel::sparql
