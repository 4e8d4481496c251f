// SPDX-License-Identifier: Apache-2.0
// Values of xsd:dateTime, date, time and durations: parsing, comparison with time zones, arithmetic.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rdf/terms/literal_date.hpp"
#include "sparql/values/decimal.hpp"

namespace cluxel::sparql {

/// The seven-property model of XML Schema 1.1. Fields that xsd:time and the g-types (gYear, gMonthDay …) lack keep
/// their defaults.
struct CalendarTime {
  std::int64_t year = 1972;
  int month = 12, day = 31, hour = 0, minute = 0;
  Decimal second;
  std::optional<int> zone_minutes;  ///< east of UTC

  /// Seconds since 1970-01-01T00:00:00Z; `missing_zone_minutes` applies to a value without a zone.
  Decimal timeline(int missing_zone_minutes = 0) const;
};

using rdf::CalendarKind;

/// Resets the fields that the type lacks to their defaults, after a cast or an addition.
CalendarTime withoutAbsentParts(CalendarKind kind, CalendarTime time);
/// None when the text is not in the lexical space, or its year has more than 11 digits, so that seconds fit 64 bits.
std::optional<CalendarTime> parseCalendar(CalendarKind kind, std::string_view text);
std::string formatCalendar(CalendarKind kind, const CalendarTime& value);

/// The XPath comparison; unordered when exactly one value has a zone and they are less than 14 hours apart.
std::partial_ordering compareCalendar(const CalendarTime& a, const CalendarTime& b);
/// A total order that extends compareCalendar() (a missing zone is taken as UTC).
std::strong_ordering orderCalendar(const CalendarTime& a, const CalendarTime& b);

/// Months and seconds, with the same sign.
struct Duration {
  std::int64_t months = 0;
  Decimal seconds;
  bool operator==(const Duration&) const = default;
};

enum class DurationKind : std::uint8_t { Duration, DayTime, YearMonth };

std::optional<Duration> parseDuration(DurationKind kind, std::string_view text);
std::string formatDuration(DurationKind kind, const Duration& value);
/// Unordered when the result depends on the starting point.
std::partial_ordering compareDuration(const Duration& a, const Duration& b);

/// Adds a duration by the algorithm of XML Schema 1.1 appendix E; none on overflow.
std::optional<CalendarTime> addDuration(const CalendarTime& time, const Duration& duration, bool subtract);
/// a - b; a missing zone is taken as UTC.
std::optional<Duration> difference(const CalendarTime& a, const CalendarTime& b);

/// The UTC time for microseconds since 1970-01-01T00:00:00Z.
CalendarTime calendarFromMicroseconds(std::int64_t microseconds);

}  // namespace cluxel::sparql
