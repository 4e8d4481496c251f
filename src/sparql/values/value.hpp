// SPDX-License-Identifier: Apache-2.0
// Values in SPARQL expressions: the value of a stored term, or a computed value.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "rdf/store/quad_store.hpp"
#include "sparql/values/calendar.hpp"
#include "sparql/values/decimal.hpp"

namespace cluxel::sparql {

/// The id of a term within one query: below kFirstComputed a stored term, from there on a computed one; 0 is unbound.
using ValueId = std::uint32_t;
inline constexpr ValueId kUnbound = 0;
inline constexpr ValueId kFirstComputed = 0x8000'0000u;

/// The text of a computed string, IRI or blank node, and the language of a langString.
struct TextPayload {
  std::string text, language;
};

/// Small enough to be passed by value. The value of a term keeps the term's id and thus its lexical form; a computed
/// value has no id and the canonical lexical form.
struct Value {
  enum class Type : std::uint8_t {
    None,  ///< unbound, or an error
    Iri,
    Blank,
    Boolean,
    Integer,
    Decimal,
    Float,
    Double,
    String,
    LangString,
    DateTime,
    Date,
    Time,
    Calendar /* gYear … */,
    Duration,
    DayTimeDuration,
    YearMonthDuration,
    Other  ///< a literal of an unknown datatype, or an ill-typed one
  };
  using Payload = std::variant<TextPayload, Decimal, CalendarTime, Duration>;

  Type type = Type::None;
  CalendarKind calendar = CalendarKind::DateTime;
  static constexpr std::uint8_t kNoScale = rdf::DecodedValue::kNoScale;
  std::uint8_t scale =
      0;  ///< a Decimal without payload is integer * 10^-scale; kNoScale: the digits are only in its term
  ValueId id = kUnbound;
  std::int64_t integer = 0;  ///< Boolean, Integer without payload; the digits of a Decimal without payload
  double number = 0;         ///< the value of Float and Double; an approximation for Integer and Decimal
  std::shared_ptr<const Payload> payload;  ///< of computed texts, calendar values, and exact or large numbers

  bool isError() const { return type == Type::None; }
  explicit operator bool() const { return type != Type::None; }
  bool isNumeric() const { return type >= Type::Integer && type <= Type::Double; }
  bool isLiteral() const { return type >= Type::Boolean; }
  bool isStringLike() const { return type == Type::String || type == Type::LangString; }
  bool isCalendar() const { return type >= Type::DateTime && type <= Type::Calendar; }
  bool isDuration() const { return type >= Type::Duration && type <= Type::YearMonthDuration; }

  /// The exact value of an Integer or of a Decimal with known scale.
  Decimal exact() const;

  static Value boolean(bool value);
  static Value ofInteger(std::int64_t value);
  static Value ofInteger(const Decimal& whole);
  static Value ofDecimal(Decimal value);
  static Value ofFloat(float value);
  static Value ofDouble(double value);
  static Value string(std::string text);
  static Value langString(std::string text, std::string language);
  static Value iri(std::string text);
  static Value blank(std::string label);
  static Value ofCalendar(CalendarKind kind, CalendarTime time);
  static Value ofDuration(DurationKind kind, Duration duration);
};

/// The value of a term, without id.
Value valueOfTerm(TermKind kind, std::string_view text, std::string_view datatype, std::string_view language);
inline Value valueOfTerm(const Term& term) {
  return valueOfTerm(term.kind, term.text, term.datatype, term.language);
}

/// The term of a computed value, in canonical lexical form. Not for values that have only an id.
Term termOfComputed(const Value& value);

/// The XSD 1.1 canonical form ("1.0E0", "INF") with the shortest digits that round-trip.
std::string canonicalText(double value);
std::string canonicalText(float value);
/// Parses the lexical form of xsd:double or xsd:float; none for other text.
std::optional<double> parseDouble(std::string_view text);
std::optional<float> parseFloat(std::string_view text);
/// Parses the lexical form of xsd:boolean.
std::optional<bool> parseBoolean(std::string_view text);

}  // namespace cluxel::sparql
