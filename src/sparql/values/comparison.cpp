// SPDX-License-Identifier: Apache-2.0
// Value comparison (SPARQL 1.1 section 17.3, by XPath), and a total order that extends section 15.1.
#include "sparql/values/comparison.hpp"

#include <cmath>
#include <tuple>

#include "sparql/values/datatype.hpp"

namespace cluxel::sparql {
namespace {

using Type = Value::Type;

std::partial_ordering compareNumbers(const Value& a, const Value& b, const QueryTerms& terms) {
  if (a.type == Type::Integer && b.type == Type::Integer && !a.payload && !b.payload) return a.integer <=> b.integer;
  if (a.type == Type::Double || b.type == Type::Double) return a.number <=> b.number;
  if (a.type == Type::Float || b.type == Type::Float) {
    return static_cast<float>(a.number) <=> static_cast<float>(b.number);
  }
  // Two exact numbers: their doubles decide unless the difference is within rounding error.
  const double gap = std::abs(a.number - b.number);
  if (gap > 1e-14 * (std::abs(a.number) + std::abs(b.number))) return a.number <=> b.number;
  return terms.exactOf(a) <=> terms.exactOf(b);
}

/// Types with known value spaces, so that values of two different types are unequal.
bool isKnown(const Value& value) {
  return value.type != Type::Other;
}

bool comparableCalendars(const Value& a, const Value& b) {
  return a.isCalendar() && a.type == b.type && a.calendar == b.calendar;
}

/// The rank of literal types in ORDER BY.
int rankOf(const Value& value) {
  switch (value.type) {
    case Type::None:
      return 0;
    case Type::Blank:
      return 1;
    case Type::Iri:
      return 2;
    case Type::Integer:
    case Type::Decimal:
    case Type::Float:
    case Type::Double:
      return 3;
    case Type::String:
      return 4;
    case Type::LangString:
      return 5;
    case Type::Boolean:
      return 6;
    case Type::DateTime:
      return 7;
    case Type::Date:
      return 8;
    case Type::Time:
      return 9;
    case Type::Calendar:
      return 10 + static_cast<int>(value.calendar);
    case Type::Duration:
    case Type::DayTimeDuration:
    case Type::YearMonthDuration:
      return 20;
    case Type::Other:
      return 21;
  }
  return 22;
}

/// Orders numbers of all types by exact value; NaN first.
std::strong_ordering orderNumbers(const Value& a, const Value& b, const QueryTerms& terms) {
  const bool nan_a = std::isnan(a.number), nan_b = std::isnan(b.number);
  if (nan_a || nan_b) return nan_b <=> nan_a;
  if (a.number < b.number && !(a.payload || b.payload)) return std::strong_ordering::less;
  if (a.number > b.number && !(a.payload || b.payload)) return std::strong_ordering::greater;
  if (std::isinf(a.number) || std::isinf(b.number)) {
    return a.number < b.number   ? std::strong_ordering::less
           : a.number > b.number ? std::strong_ordering::greater
                                 : std::strong_ordering::equal;
  }
  const auto exact = [&](const Value& value) {
    const bool real = value.type == Type::Float || value.type == Type::Double;
    return real ? *Decimal::fromDouble(value.number) : terms.exactOf(value);
  };
  const bool both_real = a.type >= Type::Float && b.type >= Type::Float;
  return both_real ? std::strong_ordering::equal : exact(a) <=> exact(b);
}

std::strong_ordering orderDurations(const Duration& a, const Duration& b) {
  // Average month lengths give a total order close to the partial order of durations.
  const Decimal month_seconds(2629746);
  const auto sizeOf = [&](const Duration& d) {
    return Decimal::add(d.seconds, *Decimal::multiply(Decimal(d.months), month_seconds)).value_or(d.seconds);
  };
  const auto order = sizeOf(a) <=> sizeOf(b);
  return order != 0 ? order : a.months <=> b.months;
}

std::strong_ordering orderTexts(const std::string& a, const std::string& b) {
  return a.compare(b) <=> 0;
}

}  // namespace

std::optional<bool> equals(const Value& a, const Value& b, const QueryTerms& terms) {
  if (a.isError() || b.isError()) return std::nullopt;
  if (a.isNumeric() && b.isNumeric()) return compareNumbers(a, b, terms) == 0;
  if (a.id != kUnbound && a.id == b.id) {
    // Identical ill-typed or unknown literals are equal.
    return true;
  }
  if (a.type == Type::Boolean && b.type == Type::Boolean) return a.integer == b.integer;
  if (a.isDuration() && b.isDuration()) return terms.durationOf(a) == terms.durationOf(b);
  if (comparableCalendars(a, b)) {
    const auto order = compareCalendar(terms.calendarOf(a), terms.calendarOf(b));
    if (order == std::partial_ordering::unordered) return std::nullopt;
    return order == 0;
  }
  if (sameTerm(a, b, terms)) return true;
  if (!a.isLiteral() || !b.isLiteral()) return false;
  // A language-tagged literal is unequal to every literal without that tag.
  if (a.type == Type::LangString || b.type == Type::LangString) return false;
  if (!isKnown(a) || !isKnown(b)) return std::nullopt;
  return false;
}

std::optional<std::partial_ordering> compare(const Value& a, const Value& b, const QueryTerms& terms) {
  if (a.isNumeric() && b.isNumeric()) return compareNumbers(a, b, terms);
  if (a.type == Type::String && b.type == Type::String) {
    std::string scratch_a, scratch_b;
    return terms.textOf(a, scratch_a).compare(terms.textOf(b, scratch_b)) <=> 0;
  }
  if (a.type == Type::Boolean && b.type == Type::Boolean) return a.integer <=> b.integer;
  if (comparableCalendars(a, b) && a.type != Type::Calendar) {
    const auto order = compareCalendar(terms.calendarOf(a), terms.calendarOf(b));
    if (order == std::partial_ordering::unordered) return std::nullopt;
    return order;
  }
  if (a.isDuration() && b.isDuration()) return compareDuration(terms.durationOf(a), terms.durationOf(b));
  return std::nullopt;
}

bool sameTerm(const Value& a, const Value& b, const QueryTerms& terms) {
  if (a.id != kUnbound && b.id != kUnbound) return a.id == b.id;
  if (a.isError() || b.isError() || a.type != b.type) return false;
  return terms.termOf(a) == terms.termOf(b);
}

std::optional<bool> effectiveBoolean(const Value& value, const QueryTerms& terms) {
  switch (value.type) {
    case Type::Boolean:
      return value.integer != 0;
    case Type::Integer:
      if (!value.payload) return value.integer != 0;
      return true;
    case Type::Decimal:
      return value.number != 0;
    case Type::Float:
    case Type::Double:
      return value.number != 0 && !std::isnan(value.number);
    case Type::String:
      return !terms.textOf(value).empty();
    case Type::LangString:
      return !terms.textOf(value).empty();
    case Type::Other: {
      // The effective boolean value of an ill-typed number or boolean is false.
      const std::string datatype = terms.datatypeOf(value);
      const Value::Type type = valueTypeOfDatatype(datatype);
      if (type == Type::Boolean || (type >= Type::Integer && type <= Type::Double)) return false;
      return std::nullopt;
    }
    default:
      return std::nullopt;
  }
}

std::uint32_t orderRankOf(const Value& value) {
  return static_cast<std::uint32_t>(rankOf(value));
}

std::strong_ordering valueOrderOf(const Value& a, const Value& b, const QueryTerms& terms) {
  const int rank = rankOf(a);
  if (const auto order = rank <=> rankOf(b); order != 0) return order;
  if (a.isError() || (a.id != kUnbound && a.id == b.id)) return std::strong_ordering::equal;
  if (a.isNumeric()) return orderNumbers(a, b, terms);
  if (a.type == Type::Boolean) return a.integer <=> b.integer;
  if (a.isCalendar()) return orderCalendar(terms.calendarOf(a), terms.calendarOf(b));
  if (a.isDuration()) return orderDurations(terms.durationOf(a), terms.durationOf(b));
  return orderTexts(terms.textOf(a), terms.textOf(b));
}

std::strong_ordering termOrderOf(const Value& a, const Value& b, const QueryTerms& terms) {
  if (a.isError() || b.isError()) return b.isError() <=> a.isError();
  if (a.id != kUnbound && a.id == b.id) return std::strong_ordering::equal;
  if (a.id == kUnbound || b.id == kUnbound) return terms.termOf(a) <=> terms.termOf(b);
  return termOrderOf(a.id, b.id, terms);
}

std::strong_ordering termOrderOf(ValueId a, ValueId b, const QueryTerms& terms) {
  if (a == b || a == kUnbound || b == kUnbound) return (a != kUnbound) <=> (b != kUnbound);
  const rdf::TermView x = terms.view(a), y = terms.view(b);
  return std::tie(x.kind, x.text, x.datatype, x.language) <=> std::tie(y.kind, y.text, y.datatype, y.language);
}

std::strong_ordering orderOf(const Value& a, const Value& b, const QueryTerms& terms) {
  const auto order = valueOrderOf(a, b, terms);
  return order != 0 ? order : termOrderOf(a, b, terms);
}

}  // namespace cluxel::sparql
