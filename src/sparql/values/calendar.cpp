// SPDX-License-Identifier: Apache-2.0
// Points in time: lexical forms, comparison and arithmetic.
#include "sparql/values/calendar.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>

namespace cluxel::sparql {
namespace {

constexpr std::int64_t kSecondsPerDay = 86400;
constexpr int kMaxZoneMinutes = 14 * 60;

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

void setDate(CalendarTime& time, const rdf::CivilDate& date) {
  time.year = date.year, time.month = date.month, time.day = date.day;
}

CalendarTime fromTimeline(const Decimal& seconds, std::optional<int> zone) {
  CalendarTime out;
  const Decimal local = zone ? *Decimal::add(seconds, Decimal(std::int64_t{*zone} * 60)) : seconds;
  const Decimal whole = local.floor();
  const std::int64_t total = whole.toInt64().value_or(0);
  const std::int64_t days = total >= 0 ? total / kSecondsPerDay : -((-total + kSecondsPerDay - 1) / kSecondsPerDay);
  const std::int64_t rest = total - days * kSecondsPerDay;
  setDate(out, rdf::civilFromDays(days));
  out.hour = static_cast<int>(rest / 3600);
  out.minute = static_cast<int>(rest / 60 % 60);
  out.second = *Decimal::add(Decimal(rest % 60), *Decimal::subtract(local, whole));
  out.zone_minutes = zone;
  return out;
}

}  // namespace

Decimal CalendarTime::timeline(int missing_zone_minutes) const {
  const std::int64_t whole = rdf::daysFromCivil({year, month, day}) * kSecondsPerDay + hour * 3600 + minute * 60 -
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
  constexpr std::size_t kMaxFractionDigits = 100;
  const std::optional<rdf::CalendarFields> fields = rdf::parseCalendarFields(kind, text);
  if (!fields || fields->fraction.size() > kMaxFractionDigits) return std::nullopt;
  CalendarTime time;
  setDate(time, fields->date);
  time.hour = fields->hour, time.minute = fields->minute;
  time.second = Decimal(fields->second);
  if (!fields->fraction.empty())
    time.second = *Decimal::parse(std::to_string(fields->second) + "." + std::string(fields->fraction));
  time.zone_minutes = fields->zone_minutes;
  return time;
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
  moved.day = std::min(moved.day, rdf::daysInMonth(moved.year, moved.month));
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
