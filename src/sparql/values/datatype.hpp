// SPDX-License-Identifier: Apache-2.0
// The supported datatypes, with the ranges of the integer types.
#pragma once

#include <string_view>

#include "sparql/values/value.hpp"

namespace cluxel::sparql {

struct DatatypeInfo {
  std::string_view local;  ///< after the xsd namespace
  Value::Type type = Value::Type::Other;
  CalendarKind calendar = CalendarKind::DateTime;
  std::string_view min = {}, max = {};  ///< range of an integer type; empty if unbounded

  bool inRange(const Decimal& value) const;
};

/// Null for an unsupported datatype.
const DatatypeInfo* findDatatype(std::string_view iri);

/// The datatype IRI of a computed literal; empty for IRIs, blank nodes and errors.
std::string_view datatypeIri(const Value& value);

/// The type of well-formed literals of a datatype; Other for unsupported datatypes.
Value::Type valueTypeOfDatatype(std::string_view iri);

DurationKind durationKind(Value::Type type);

}  // namespace cluxel::sparql
