// SPDX-License-Identifier: Apache-2.0
// Accessors of dates and times, and NOW. As an extension, YEAR, MONTH, DAY also accept xsd:date, and HOURS, MINUTES,
// SECONDS xsd:time.
#include "sparql/functions/function_bodies.hpp"

namespace cluxel::sparql {
namespace {

using Type = Value::Type;

template <typename Part>
Value dayPart(const Value& value, FunctionContext& context, Part part) {
  if (value.type != Type::DateTime && value.type != Type::Date) return {};
  return Value::ofInteger(part(context.terms.calendarOf(value)));
}

template <typename Part>
Value clockPart(const Value& value, FunctionContext& context, Part part) {
  if (value.type != Type::DateTime && value.type != Type::Time) return {};
  return part(context.terms.calendarOf(value));
}

}  // namespace

Value yearFunction(Arguments arguments, FunctionContext& context) {
  return dayPart(arguments[0], context, [](const CalendarTime& time) { return time.year; });
}

Value monthFunction(Arguments arguments, FunctionContext& context) {
  return dayPart(arguments[0], context, [](const CalendarTime& time) { return time.month; });
}

Value dayFunction(Arguments arguments, FunctionContext& context) {
  return dayPart(arguments[0], context, [](const CalendarTime& time) { return time.day; });
}

Value hoursFunction(Arguments arguments, FunctionContext& context) {
  return clockPart(arguments[0], context, [](const CalendarTime& time) { return Value::ofInteger(time.hour); });
}

Value minutesFunction(Arguments arguments, FunctionContext& context) {
  return clockPart(arguments[0], context, [](const CalendarTime& time) { return Value::ofInteger(time.minute); });
}

Value secondsFunction(Arguments arguments, FunctionContext& context) {
  return clockPart(arguments[0], context, [](const CalendarTime& time) { return Value::ofDecimal(time.second); });
}

Value timezoneFunction(Arguments arguments, FunctionContext& context) {
  if (!arguments[0].isCalendar()) return {};
  const auto zone = context.terms.calendarOf(arguments[0]).zone_minutes;
  if (!zone) return {};
  return Value::ofDuration(DurationKind::DayTime, {0, Decimal(std::int64_t{*zone} * 60)});
}

Value tzFunction(Arguments arguments, FunctionContext& context) {
  if (!arguments[0].isCalendar()) return {};
  CalendarTime time = context.terms.calendarOf(arguments[0]);
  // The zone follows the ten characters of a date.
  time.year = 2000;
  return Value::string(formatCalendar(CalendarKind::Date, time).substr(10));
}

Value nowFunction(Arguments, FunctionContext& context) {
  return Value::ofCalendar(CalendarKind::DateTime, calendarFromMicroseconds(context.now_us));
}

}  // namespace cluxel::sparql
