// SPDX-License-Identifier: Apache-2.0
// Points of time: the proleptic Gregorian calendar, lexical forms and comparison.
#include "sparql/calendar.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>

namespace cluxel::sparql {
namespace {

constexpr std::int64_t kSecondsPerDay = 86400;
constexpr int kMaxZoneMinutes = 14 * 60;

/// Days since 1970-01-01, for any year (Hinnant's civil-day arithmetic on 400-year eras).
std::int64_t daysFromCivil(std::int64_t year, int month, int day) {
  year -= month <= 2 ? 1 : 0;
  const std::int64_t era = (year >= 0 ? year : year - 399) / 400;
  const std::int64_t year_of_era = year - era * 400;
  const std::int64_t day_of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  const std::int64_t day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
  return era * 146097 + day_of_era - 719468;
}

void civilFromDays(std::int64_t days, CalendarTime& out) {
  days += 719468;
  const std::int64_t era = (days >= 0 ? days : days - 146096) / 146097;
  const std::int64_t day_of_era = days - era * 146097;
  const std::int64_t year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36524 - day_of_era / 146096) / 365;
  const std::int64_t day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
  const std::int64_t shifted_month = (5 * day_of_year + 2) / 153;
  out.day = static_cast<int>(day_of_year - (153 * shifted_month + 2) / 5 + 1);
  out.month = static_cast<int>(shifted_month < 10 ? shifted_month + 3 : shifted_month - 9);
  out.year = year_of_era + era * 400 + (out.month <= 2 ? 1 : 0);
}

int daysInMonth(std::int64_t year, int month) {
  constexpr std::array<int, 12> kDays = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  return kDays[static_cast<std::size_t>(month - 1)] + (month == 2 && leap ? 1 : 0);
}

/// Reads fixed forms from the front of a text.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}
  bool done() const { return text_.empty(); }
  bool is(char c) const { return !text_.empty() && text_.front() == c; }
  bool take(char c) {
    if (!is(c)) return false;
    text_.remove_prefix(1);
    return true;
  }
  std::string_view digits() {
    std::size_t n = 0;
    while (n < text_.size() && text_[n] >= '0' && text_[n] <= '9') ++n;
    const std::string_view result = text_.substr(0, n);
    text_.remove_prefix(n);
    return result;
  }
  /// Exactly two digits within [low, high].
  bool two(int& out, int low, int high) {
    if (text_.size() < 2 || !isDigit(text_[0]) || !isDigit(text_[1])) return false;
    out = (text_[0] - '0') * 10 + (text_[1] - '0');
    text_.remove_prefix(2);
    return low <= out && out <= high;
  }
  bool year(std::int64_t& out) {
    const bool negative = take('-');
    const std::string_view found = digits();
    if (found.size() < 4 || found.size() > 11 || (found.size() > 4 && found.front() == '0')) return false;
    out = 0;
    for (const char c : found) out = out * 10 + (c - '0');
    if (negative) out = -out;
    return true;
  }
  bool seconds(Decimal& out) {
    int whole = 0;
    if (!two(whole, 0, 59)) return false;
    out = Decimal(whole);
    if (!take('.')) return true;
    const std::string_view fraction = digits();
    if (fraction.empty() || fraction.size() > 100) return false;
    out = *Decimal::parse(std::to_string(whole) + "." + std::string(fraction));
    return true;
  }
  bool zone(std::optional<int>& out) {
    if (take('Z')) {
      out = 0;
      return true;
    }
    if (!is('+') && !is('-')) return true;
    const int sign = take('-') ? -1 : (take('+'), 1);
    int hours = 0, minutes = 0;
    if (!two(hours, 0, 14) || !take(':') || !two(minutes, 0, 59)) return false;
    out = sign * (hours * 60 + minutes);
    return std::abs(*out) <= kMaxZoneMinutes;
  }

 private:
  static bool isDigit(char c) { return c >= '0' && c <= '9'; }
  std::string_view text_;
};

bool readClock(Scanner& in, CalendarTime& out, bool& midnight_24) {
  if (!in.two(out.hour, 0, 24) || !in.take(':') || !in.two(out.minute, 0, 59) || !in.take(':') ||
      !in.seconds(out.second)) {
    return false;
  }
  midnight_24 = out.hour == 24;
  return !midnight_24 || (out.minute == 0 && out.second.isZero());
}

bool readParts(CalendarKind kind, Scanner& in, CalendarTime& out, bool& midnight_24) {
  switch (kind) {
    case CalendarKind::DateTime:
      return in.year(out.year) && in.take('-') && in.two(out.month, 1, 12) && in.take('-') &&
             in.two(out.day, 1, daysInMonth(out.year, out.month)) && in.take('T') && readClock(in, out, midnight_24);
    case CalendarKind::Date:
      return in.year(out.year) && in.take('-') && in.two(out.month, 1, 12) && in.take('-') &&
             in.two(out.day, 1, daysInMonth(out.year, out.month));
    case CalendarKind::Time:
      return readClock(in, out, midnight_24);
    case CalendarKind::YearMonth:
      out.day = 1;
      return in.year(out.year) && in.take('-') && in.two(out.month, 1, 12);
    case CalendarKind::Year:
      out.month = out.day = 1;
      return in.year(out.year);
    case CalendarKind::MonthDay:
      return in.take('-') && in.take('-') && in.two(out.month, 1, 12) && in.take('-') &&
             in.two(out.day, 1, daysInMonth(1972, out.month));
    case CalendarKind::Day:
      return in.take('-') && in.take('-') && in.take('-') && in.two(out.day, 1, 31);
    case CalendarKind::Month:
      out.day = 1;
      return in.take('-') && in.take('-') && in.two(out.month, 1, 12);
  }
  return false;
}

std::string two(int value) {
  return {static_cast<char>('0' + value / 10), static_cast<char>('0' + value % 10)};
}

std::string yearText(std::int64_t year) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%s%04lld", year < 0 ? "-" : "",
                static_cast<long long>(year < 0 ? -year : year));
  return buffer.data();
}

std::string clockText(const CalendarTime& value) {
  std::string seconds = value.second.text();
  if (value.second < Decimal(10)) seconds.insert(0, "0");
  return two(value.hour) + ":" + two(value.minute) + ":" + seconds;
}

std::string zoneText(std::optional<int> zone) {
  if (!zone) return {};
  if (*zone == 0) return "Z";
  const int size = std::abs(*zone);
  return (*zone < 0 ? "-" : "+") + two(size / 60) + ":" + two(size % 60);
}

CalendarTime fromTimeline(const Decimal& seconds, std::optional<int> zone) {
  CalendarTime out;
  const Decimal local = zone ? *Decimal::add(seconds, Decimal(std::int64_t{*zone} * 60)) : seconds;
  const Decimal whole = local.floor();
  const std::int64_t total = whole.toInt64().value_or(0);
  const std::int64_t days = total >= 0 ? total / kSecondsPerDay : -((-total + kSecondsPerDay - 1) / kSecondsPerDay);
  const std::int64_t rest = total - days * kSecondsPerDay;
  civilFromDays(days, out);
  out.hour = static_cast<int>(rest / 3600);
  out.minute = static_cast<int>(rest / 60 % 60);
  out.second = *Decimal::add(Decimal(rest % 60), *Decimal::subtract(local, whole));
  out.zone_minutes = zone;
  return out;
}

}  // namespace

Decimal CalendarTime::timeline(int missing_zone_minutes) const {
  const std::int64_t whole = daysFromCivil(year, month, day) * kSecondsPerDay + hour * 3600 + minute * 60 -
                             std::int64_t{zone_minutes.value_or(missing_zone_minutes)} * 60;
  return *Decimal::add(Decimal(whole), second);
}

CalendarTime withoutAbsentParts(CalendarKind kind, CalendarTime time) {
  using Kind = CalendarKind;
  const CalendarTime absent;
  const bool has_clock = kind == Kind::DateTime || kind == Kind::Time,
             is_day = kind == Kind::DateTime || kind == Kind::Date;
  if (!has_clock) time.hour = absent.hour, time.minute = absent.minute, time.second = absent.second;
  if (!is_day && kind != Kind::YearMonth && kind != Kind::Year) time.year = absent.year;
  if (kind == Kind::Time || kind == Kind::Day) time.month = absent.month;
  if (kind == Kind::Time) time.day = absent.day;
  if (kind == Kind::Year) time.month = 1;
  if (kind == Kind::Year || kind == Kind::YearMonth || kind == Kind::Month) time.day = 1;
  return time;
}

std::optional<CalendarTime> parseCalendar(CalendarKind kind, std::string_view text) {
  Scanner in(text);
  CalendarTime out;
  bool midnight_24 = false;
  if (!readParts(kind, in, out, midnight_24) || !in.zone(out.zone_minutes) || !in.done()) return std::nullopt;
  if (midnight_24) {
    out.hour = 0;
    if (kind == CalendarKind::DateTime) civilFromDays(daysFromCivil(out.year, out.month, out.day) + 1, out);
  }
  return out;
}

std::string formatCalendar(CalendarKind kind, const CalendarTime& value) {
  const std::string date = yearText(value.year) + "-" + two(value.month) + "-" + two(value.day);
  switch (kind) {
    case CalendarKind::DateTime:
      return date + "T" + clockText(value) + zoneText(value.zone_minutes);
    case CalendarKind::Date:
      return date + zoneText(value.zone_minutes);
    case CalendarKind::Time:
      return clockText(value) + zoneText(value.zone_minutes);
    case CalendarKind::YearMonth:
      return yearText(value.year) + "-" + two(value.month) + zoneText(value.zone_minutes);
    case CalendarKind::Year:
      return yearText(value.year) + zoneText(value.zone_minutes);
    case CalendarKind::MonthDay:
      return "--" + two(value.month) + "-" + two(value.day) + zoneText(value.zone_minutes);
    case CalendarKind::Day:
      return "---" + two(value.day) + zoneText(value.zone_minutes);
    case CalendarKind::Month:
      return "--" + two(value.month) + zoneText(value.zone_minutes);
  }
  return {};
}

std::partial_ordering compareCalendar(const CalendarTime& a, const CalendarTime& b) {
  if (a.zone_minutes.has_value() == b.zone_minutes.has_value()) return a.timeline() <=> b.timeline();
  const CalendarTime& with = a.zone_minutes ? a : b;
  const CalendarTime& without = a.zone_minutes ? b : a;
  const Decimal fixed = with.timeline();
  std::partial_ordering order = std::partial_ordering::unordered;
  if (fixed < without.timeline(kMaxZoneMinutes)) order = std::partial_ordering::less;
  if (fixed > without.timeline(-kMaxZoneMinutes)) order = std::partial_ordering::greater;
  return a.zone_minutes ? order : 0 <=> order;
}

std::strong_ordering orderCalendar(const CalendarTime& a, const CalendarTime& b) {
  const auto order = a.timeline() <=> b.timeline();
  if (order != 0) return order;
  return a.zone_minutes.value_or(-10000) <=> b.zone_minutes.value_or(-10000);
}

std::optional<CalendarTime> addDuration(const CalendarTime& time, const Duration& duration, bool subtract) {
  CalendarTime moved = time;
  const std::int64_t months = subtract ? -duration.months : duration.months;
  const std::int64_t month_index = moved.year * 12 + (moved.month - 1) + months;
  const std::int64_t year = month_index >= 0 ? month_index / 12 : -((-month_index + 11) / 12);
  if (std::abs(year) > 100'000'000) return std::nullopt;
  moved.year = year;
  moved.month = static_cast<int>(month_index - year * 12) + 1;
  moved.day = std::min(moved.day, daysInMonth(moved.year, moved.month));
  const auto shifted = subtract ? Decimal::subtract(moved.timeline(), duration.seconds)
                                : Decimal::add(moved.timeline(), duration.seconds);
  if (!shifted || shifted->toDouble() > 3e15 || shifted->toDouble() < -3e15) return std::nullopt;
  return fromTimeline(*shifted, moved.zone_minutes);
}

std::optional<Duration> difference(const CalendarTime& a, const CalendarTime& b) {
  const auto seconds = Decimal::subtract(a.timeline(), b.timeline());
  if (!seconds) return std::nullopt;
  return Duration{0, *seconds};
}

CalendarTime calendarFromMicroseconds(std::int64_t microseconds) {
  return fromTimeline(Decimal(Decimal::Integer(microseconds), 6), 0);
}

}  // namespace cluxel::sparql
