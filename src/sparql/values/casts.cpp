// SPDX-License-Identifier: Apache-2.0
// Casts between XML Schema datatypes: the table of SPARQL 1.1 section 17.5, extended to the other supported types.
#include <cmath>

#include "base/ascii.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/functions/functions.hpp"
#include "sparql/values/datatype.hpp"

namespace cluxel::sparql {
namespace {

using Type = Value::Type;

/// The XPath string form of a number: plain notation between 1e-6 and 1e6, else the canonical form.
template <typename Real>
std::string realText(Real value) {
  const Real size = std::abs(value);
  if (value == 0) return std::signbit(value) ? "-0" : "0";
  if (!(size >= Real(1e-6) && size < Real(1e6))) return canonicalText(value);
  const std::string scientific = canonicalText(value);
  const std::size_t e = scientific.find('E');
  const auto mantissa = Decimal::parse(scientific.substr(0, e));
  const int exponent = std::stoi(scientific.substr(e + 1));
  const Decimal power(boost::multiprecision::pow(Decimal::Integer(10), static_cast<unsigned>(std::abs(exponent))));
  const auto plain = exponent < 0
                         ? Decimal::multiply(*mantissa, Decimal(Decimal::Integer(1), static_cast<unsigned>(-exponent)))
                         : Decimal::multiply(*mantissa, power);
  return plain->text();
}

Value toString(const Value& value, FunctionContext& context) {
  switch (value.type) {
    case Type::String:
      return value;
    case Type::Blank:
      return {};
    case Type::Boolean:
      return Value::string(value.integer != 0 ? "true" : "false");
    case Type::Integer:
    case Type::Decimal:
      return Value::string(context.terms.exactOf(value).text());
    case Type::Float:
      return Value::string(realText(static_cast<float>(value.number)));
    case Type::Double:
      return Value::string(realText(value.number));
    default:
      return Value::string(context.terms.textOf(value));
  }
}

Value toBoolean(const Value& value) {
  if (value.type == Type::Boolean) return Value::boolean(value.integer != 0);
  if (value.isNumeric()) return Value::boolean(value.number != 0 && !std::isnan(value.number));
  return {};
}

std::optional<Decimal> exactNumber(const Value& value, FunctionContext& context) {
  switch (value.type) {
    case Type::Boolean:
      return Decimal(value.integer);
    case Type::Integer:
    case Type::Decimal:
      return context.terms.exactOf(value);
    case Type::Float:
    case Type::Double:
      return Decimal::fromDouble(value.number);
    default:
      return std::nullopt;
  }
}

std::optional<double> realNumber(const Value& value) {
  if (value.type == Type::Boolean) return static_cast<double>(value.integer);
  if (value.isNumeric()) return value.number;
  return std::nullopt;
}

Value toDecimal(const Value& value, FunctionContext& context) {
  if (value.type == Type::Float || value.type == Type::Double) {
    // The shortest decimal that reads back as the number, as XPath implementations print it.
    if (!std::isfinite(value.number)) return {};
    const std::string text =
        value.type == Type::Float ? canonicalText(static_cast<float>(value.number)) : canonicalText(value.number);
    const std::size_t e = text.find('E');
    const int exponent = std::stoi(text.substr(e + 1));
    const Decimal mantissa = *Decimal::parse(text.substr(0, e));
    const auto size = static_cast<unsigned>(std::abs(exponent));
    const Decimal scale = exponent < 0 ? Decimal(Decimal::Integer(1), size)
                                       : Decimal(boost::multiprecision::pow(Decimal::Integer(10), size));
    return Value::ofDecimal(*Decimal::multiply(mantissa, scale));
  }
  auto number = exactNumber(value, context);
  return number ? Value::ofDecimal(std::move(*number)) : Value();
}

Value toInteger(const Value& value, const DatatypeInfo& info, FunctionContext& context) {
  const auto number = exactNumber(value, context);
  if (!number) return {};
  const Decimal whole(number->truncated());
  if (!info.inRange(whole)) return {};
  const Value result = Value::ofInteger(whole);
  if (info.local == "integer") return result;
  // A derived type is preserved.
  const Term term = Term::literal(whole.text(), rdf::vocabulary::xsd(info.local));
  return context.terms.valueOf(context.terms.intern(term));
}

Value toCalendar(const Value& value, CalendarKind kind, FunctionContext& context) {
  if (!value.isCalendar()) return {};
  if (value.calendar == kind) return value;
  CalendarTime time = context.terms.calendarOf(value);
  if (value.type == Type::Date && kind == CalendarKind::DateTime) {
    time.hour = time.minute = 0;
    time.second = Decimal();
    return Value::ofCalendar(kind, time);
  }
  if (value.type == Type::DateTime) return Value::ofCalendar(kind, time);
  return {};
}

Value fromText(const DatatypeInfo& info, const Value& value, FunctionContext& context) {
  const std::string text(trimmed(context.terms.textOf(value)));
  const Value read = valueOfTerm(TermKind::Literal, text, rdf::vocabulary::xsd(info.local), {});
  if (read.type == Type::Other) return {};
  // Derived integer types are preserved; other types get the canonical form.
  if (info.type == Type::Integer) return toInteger(read, info, context);
  return read;
}

}  // namespace

Value castValue(std::string_view xsd_local, const Value& value, FunctionContext& context) {
  const DatatypeInfo* info = findDatatype(rdf::vocabulary::xsd(xsd_local));
  if (info == nullptr || value.type == Type::Blank) return {};
  if (info->type == Type::String) return toString(value, context);
  if (value.type == Type::String) return fromText(*info, value, context);
  switch (info->type) {
    case Type::Boolean:
      return toBoolean(value);
    case Type::Integer:
      return toInteger(value, *info, context);
    case Type::Decimal:
      return toDecimal(value, context);
    case Type::Float: {
      const auto number = realNumber(value);
      return number ? Value::ofFloat(static_cast<float>(*number)) : Value();
    }
    case Type::Double: {
      const auto number = realNumber(value);
      return number ? Value::ofDouble(*number) : Value();
    }
    case Type::DateTime:
    case Type::Date:
    case Type::Time:
    case Type::Calendar:
      return toCalendar(value, info->calendar, context);
    case Type::Duration:
    case Type::DayTimeDuration:
    case Type::YearMonthDuration:
      return value.isDuration() && value.type == info->type ? value : Value();
    default:
      return {};
  }
}

}  // namespace cluxel::sparql
