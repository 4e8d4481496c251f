// SPDX-License-Identifier: Apache-2.0
// xsd:dateTime, date, time and durations as values: reading, comparing with time zones, arithmetic.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sparql/decimal.hpp"

namespace cluxel::sparql {

/// A point of time or a span of days: the seven-property model of XML Schema 1.1. Absent parts of xsd:time and of the
/// g-types (gYear, gMonthDay …) stay at their defaults.
struct CalendarTime {
  std::int64_t year = 1972;
  int month = 12, day = 31, hour = 0, minute = 0;
  Decimal second;
  std::optional<int> zone_minutes;  ///< east of UTC

  /// Seconds since 1970-01-01T00:00:00, at the zone given when the value has none.
  Decimal timeline(int missing_zone_minutes = 0) const;
};

/// Kinds of xsd:dateTime-like literals, by the parts that are written.
enum class CalendarKind : std::uint8_t { DateTime, Date, Time, YearMonth, Year, MonthDay, Day, Month };

/// The parts that are not written at their defaults, where a cast or a sum has left something of them.
CalendarTime withoutAbsentParts(CalendarKind kind, CalendarTime time);
/// Nothing when the text is not in the lexical space, or its year has more than 11 digits: seconds fit 64 bits.
std::optional<CalendarTime> parseCalendar(CalendarKind kind, std::string_view text);
std::string formatCalendar(CalendarKind kind, const CalendarTime& value);

/// XPath's comparison; unordered when one has a zone, the other has none, and they are less than 14 hours apart.
std::partial_ordering compareCalendar(const CalendarTime& a, const CalendarTime& b);
/// A total order that agrees with compareCalendar where that is ordered (a missing zone is taken as UTC).
std::strong_ordering orderCalendar(const CalendarTime& a, const CalendarTime& b);

/// A duration: months and seconds, both of one sign.
struct Duration {
  std::int64_t months = 0;
  Decimal seconds;
  bool operator==(const Duration&) const = default;
};

enum class DurationKind : std::uint8_t { Duration, DayTime, YearMonth };

std::optional<Duration> parseDuration(DurationKind kind, std::string_view text);
std::string formatDuration(DurationKind kind, const Duration& value);
/// Unordered where months and seconds disagree for some starting points.
std::partial_ordering compareDuration(const Duration& a, const Duration& b);

/// Adds a duration, by the algorithm of XML Schema 1.1 appendix E; nothing on overflow.
std::optional<CalendarTime> addDuration(const CalendarTime& time, const Duration& duration, bool subtract);
/// a - b; nothing when just one has a zone... the missing zone is taken as UTC.
std::optional<Duration> difference(const CalendarTime& a, const CalendarTime& b);

/// The time that many microseconds after 1970-01-01T00:00:00Z, in UTC.
CalendarTime calendarFromMicroseconds(std::int64_t microseconds);

}  // namespace cluxel::sparql
