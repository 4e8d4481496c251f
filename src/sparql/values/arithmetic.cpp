// SPDX-License-Identifier: Apache-2.0
// The arithmetic operators with XPath type promotion: integer, decimal, float, double, times with durations.
#include <cmath>

#include "sparql/functions/functions.hpp"

namespace cluxel::sparql {
namespace {

using Type = Value::Type;

/// The implementations of one operator for the numeric types.
struct Operator {
  bool (*small)(std::int64_t, std::int64_t, std::int64_t*);  ///< true on overflow
  std::optional<Decimal> (*exact)(const Decimal&, const Decimal&);
  double (*real)(double, double);
  float (*single)(float, float);
};

Value apply(const Operator& op, const Value& a, const Value& b, const QueryTerms& terms) {
  const Type type = std::max(a.type, b.type);
  if (type == Type::Double) return Value::ofDouble(op.real(a.number, b.number));
  if (type == Type::Float) {
    return Value::ofFloat(op.single(static_cast<float>(a.number), static_cast<float>(b.number)));
  }
  if (type == Type::Integer && !a.payload && !b.payload) {
    std::int64_t result = 0;
    if (!op.small(a.integer, b.integer, &result)) return Value::ofInteger(result);
  }
  const auto result = op.exact(terms.exactOf(a), terms.exactOf(b));
  if (!result) return {};
  return type == Type::Integer ? Value::ofInteger(*result) : Value::ofDecimal(*result);
}

constexpr Operator kAdd = {
    [](std::int64_t a, std::int64_t b, std::int64_t* out) { return __builtin_add_overflow(a, b, out); }, Decimal::add,
    [](double a, double b) { return a + b; }, [](float a, float b) { return a + b; }};
constexpr Operator kSubtract = {
    [](std::int64_t a, std::int64_t b, std::int64_t* out) { return __builtin_sub_overflow(a, b, out); },
    Decimal::subtract, [](double a, double b) { return a - b; }, [](float a, float b) { return a - b; }};
constexpr Operator kMultiply = {
    [](std::int64_t a, std::int64_t b, std::int64_t* out) { return __builtin_mul_overflow(a, b, out); },
    Decimal::multiply, [](double a, double b) { return a * b; }, [](float a, float b) { return a * b; }};

Value addDurations(const Value& a, const Value& b, bool subtract, const QueryTerms& terms) {
  const Duration left = terms.durationOf(a), right = terms.durationOf(b);
  Duration sum;
  const std::int64_t months = subtract ? -right.months : right.months;
  if (__builtin_add_overflow(left.months, months, &sum.months)) return {};
  const auto seconds =
      subtract ? Decimal::subtract(left.seconds, right.seconds) : Decimal::add(left.seconds, right.seconds);
  if (!seconds || (sum.months != 0 && !seconds->isZero() && (sum.months < 0) != seconds->isNegative())) return {};
  sum.seconds = *seconds;
  const Type type = a.type == b.type ? a.type : Type::Duration;
  return Value::ofDuration(type == Type::DayTimeDuration     ? DurationKind::DayTime
                           : type == Type::YearMonthDuration ? DurationKind::YearMonth
                                                             : DurationKind::Duration,
                           sum);
}

bool isDay(const Value& value) {
  return value.type == Type::DateTime || value.type == Type::Date;
}

Value moveTime(const Value& time, const Value& duration, bool subtract, const QueryTerms& terms) {
  if (!isDay(time)) return {};
  CalendarTime start = terms.calendarOf(time);
  if (time.type == Type::Date) start.hour = start.minute = 0, start.second = Decimal();
  auto moved = addDuration(start, terms.durationOf(duration), subtract);
  if (!moved) return {};
  return Value::ofCalendar(time.calendar, std::move(*moved));
}

}  // namespace

Value addValues(const Value& a, const Value& b, const QueryTerms& terms) {
  if (a.isNumeric() && b.isNumeric()) return apply(kAdd, a, b, terms);
  if (a.isDuration() && b.isDuration()) return addDurations(a, b, false, terms);
  if (a.isCalendar() && b.isDuration()) return moveTime(a, b, false, terms);
  if (a.isDuration() && b.isCalendar()) return moveTime(b, a, false, terms);
  return {};
}

Value subtractValues(const Value& a, const Value& b, const QueryTerms& terms) {
  if (a.isNumeric() && b.isNumeric()) return apply(kSubtract, a, b, terms);
  if (a.isDuration() && b.isDuration()) return addDurations(a, b, true, terms);
  if (a.isCalendar() && b.isDuration()) return moveTime(a, b, true, terms);
  if (a.isCalendar() && a.type == b.type && a.type != Type::Calendar) {
    const auto gap = difference(terms.calendarOf(a), terms.calendarOf(b));
    return gap ? Value::ofDuration(DurationKind::DayTime, *gap) : Value();
  }
  return {};
}

Value multiplyValues(const Value& a, const Value& b, const QueryTerms& terms) {
  if (!a.isNumeric() || !b.isNumeric()) return {};
  return apply(kMultiply, a, b, terms);
}

Value divideValues(const Value& a, const Value& b, const QueryTerms& terms) {
  if (!a.isNumeric() || !b.isNumeric()) return {};
  const Type type = std::max(a.type, b.type);
  if (type == Type::Double) return Value::ofDouble(a.number / b.number);
  if (type == Type::Float) return Value::ofFloat(static_cast<float>(a.number) / static_cast<float>(b.number));
  // Integers divide to a decimal.
  auto result = Decimal::divide(terms.exactOf(a), terms.exactOf(b));
  return result ? Value::ofDecimal(std::move(*result)) : Value();
}

Value negateValue(const Value& value, const QueryTerms& terms) {
  switch (value.type) {
    case Type::Integer:
      return Value::ofInteger(-terms.exactOf(value));
    case Type::Decimal:
      return Value::ofDecimal(-terms.exactOf(value));
    case Type::Float:
      return Value::ofFloat(-static_cast<float>(value.number));
    case Type::Double:
      return Value::ofDouble(-value.number);
    default:
      return {};
  }
}

}  // namespace cluxel::sparql
