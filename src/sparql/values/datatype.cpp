// SPDX-License-Identifier: Apache-2.0
// The table of supported datatypes.
#include "sparql/values/datatype.hpp"

#include <array>

#include "rdf/vocabulary.hpp"

namespace cluxel::sparql {
namespace {

using Type = Value::Type;
constexpr auto kNone = CalendarKind::DateTime;

constexpr std::array<DatatypeInfo, 32> kDatatypes = {{
    {"string", Type::String},
    {"integer", Type::Integer},
    {"double", Type::Double},
    {"decimal", Type::Decimal},
    {"boolean", Type::Boolean},
    {"float", Type::Float},
    {"dateTime", Type::DateTime, CalendarKind::DateTime},
    {"date", Type::Date, CalendarKind::Date},
    {"time", Type::Time, CalendarKind::Time},
    {"dateTimeStamp", Type::DateTime, CalendarKind::DateTime},
    {"duration", Type::Duration},
    {"dayTimeDuration", Type::DayTimeDuration},
    {"yearMonthDuration", Type::YearMonthDuration},
    {"gYear", Type::Calendar, CalendarKind::Year},
    {"gYearMonth", Type::Calendar, CalendarKind::YearMonth},
    {"gMonthDay", Type::Calendar, CalendarKind::MonthDay},
    {"gDay", Type::Calendar, CalendarKind::Day},
    {"gMonth", Type::Calendar, CalendarKind::Month},
    {"int", Type::Integer, kNone, "-2147483648", "2147483647"},
    {"long", Type::Integer, kNone, "-9223372036854775808", "9223372036854775807"},
    {"short", Type::Integer, kNone, "-32768", "32767"},
    {"byte", Type::Integer, kNone, "-128", "127"},
    {"nonNegativeInteger", Type::Integer, kNone, "0", ""},
    {"positiveInteger", Type::Integer, kNone, "1", ""},
    {"nonPositiveInteger", Type::Integer, kNone, "", "0"},
    {"negativeInteger", Type::Integer, kNone, "", "-1"},
    {"unsignedLong", Type::Integer, kNone, "0", "18446744073709551615"},
    {"unsignedInt", Type::Integer, kNone, "0", "4294967295"},
    {"unsignedShort", Type::Integer, kNone, "0", "65535"},
    {"unsignedByte", Type::Integer, kNone, "0", "255"},
    {"normalizedString", Type::Other},
    {"token", Type::Other},
}};

constexpr std::string_view kXsdString = "http://www.w3.org/2001/XMLSchema#string";

std::string_view calendarIri(CalendarKind kind) {
  switch (kind) {
    case CalendarKind::DateTime:
      return "http://www.w3.org/2001/XMLSchema#dateTime";
    case CalendarKind::Date:
      return "http://www.w3.org/2001/XMLSchema#date";
    case CalendarKind::Time:
      return "http://www.w3.org/2001/XMLSchema#time";
    case CalendarKind::YearMonth:
      return "http://www.w3.org/2001/XMLSchema#gYearMonth";
    case CalendarKind::Year:
      return "http://www.w3.org/2001/XMLSchema#gYear";
    case CalendarKind::MonthDay:
      return "http://www.w3.org/2001/XMLSchema#gMonthDay";
    case CalendarKind::Day:
      return "http://www.w3.org/2001/XMLSchema#gDay";
    case CalendarKind::Month:
      return "http://www.w3.org/2001/XMLSchema#gMonth";
  }
  return {};
}

}  // namespace

bool DatatypeInfo::inRange(const Decimal& value) const {
  return (min.empty() || value >= *Decimal::parse(min)) && (max.empty() || value <= *Decimal::parse(max));
}

const DatatypeInfo* findDatatype(std::string_view iri) {
  if (!iri.starts_with(rdf::vocabulary::kXsd)) return nullptr;
  const std::string_view local = iri.substr(rdf::vocabulary::kXsd.size());
  for (const DatatypeInfo& info : kDatatypes) {
    if (info.local == local) return &info;
  }
  return nullptr;
}

std::string_view datatypeIri(const Value& value) {
  switch (value.type) {
    case Type::Boolean:
      return "http://www.w3.org/2001/XMLSchema#boolean";
    case Type::Integer:
      return "http://www.w3.org/2001/XMLSchema#integer";
    case Type::Decimal:
      return "http://www.w3.org/2001/XMLSchema#decimal";
    case Type::Float:
      return "http://www.w3.org/2001/XMLSchema#float";
    case Type::Double:
      return "http://www.w3.org/2001/XMLSchema#double";
    case Type::String:
      return kXsdString;
    case Type::LangString:
      return "http://www.w3.org/1999/02/22-rdf-syntax-ns#langString";
    case Type::DateTime:
    case Type::Date:
    case Type::Time:
    case Type::Calendar:
      return calendarIri(value.calendar);
    case Type::Duration:
      return "http://www.w3.org/2001/XMLSchema#duration";
    case Type::DayTimeDuration:
      return "http://www.w3.org/2001/XMLSchema#dayTimeDuration";
    case Type::YearMonthDuration:
      return "http://www.w3.org/2001/XMLSchema#yearMonthDuration";
    default:
      return {};
  }
}

Value::Type valueTypeOfDatatype(std::string_view iri) {
  const DatatypeInfo* info = findDatatype(iri);
  return info == nullptr ? Type::Other : info->type;
}

DurationKind durationKind(Value::Type type) {
  return type == Type::Duration          ? DurationKind::Duration
         : type == Type::DayTimeDuration ? DurationKind::DayTime
                                         : DurationKind::YearMonth;
}

}  // namespace cluxel::sparql
