// SPDX-License-Identifier: Apache-2.0
// Parsing of xsd:dateTime, xsd:date, xsd:time and the g-types, and the proleptic Gregorian calendar.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace cluxel::rdf {

/// The XML Schema types with calendar fields, by the fields that their literals contain.
enum class CalendarKind : std::uint8_t { DateTime, Date, Time, YearMonth, Year, MonthDay, Day, Month };

/// A year of the proleptic Gregorian calendar; year 0 is 1 BC (XML Schema 1.1).
struct CivilDate {
  std::int64_t year = 1972;
  int month = 12;
  int day = 31;
};

/// Days since 1970-01-01.
std::int64_t daysFromCivil(const CivilDate& date);
CivilDate civilFromDays(std::int64_t days);
int daysInMonth(std::int64_t year, int month);

/// The fields of a literal; those that the literal does not contain keep their defaults. 24:00:00 is normalised to
/// 00:00:00 of the next day.
struct CalendarFields {
  CivilDate date;
  int hour = 0;
  int minute = 0;
  int second = 0;
  std::string_view fraction;        ///< the digits after the decimal point; a part of the text that was parsed
  std::optional<int> zone_minutes;  ///< east of UTC
};

/// None when the text is not in the lexical space of the type, or its year has more than 11 digits.
std::optional<CalendarFields> parseCalendarFields(CalendarKind kind, std::string_view lexical);

/// The microseconds since 1970-01-01T00:00:00Z of an xsd:dateTime or an xsd:date (the start of the day). None for a
/// literal without a time zone, and beyond the years ±290000, where microseconds exceed 64 bits.
std::optional<std::int64_t> parseMicroseconds(CalendarKind kind, std::string_view lexical);

}  // namespace cluxel::rdf
