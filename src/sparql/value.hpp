// SPDX-License-Identifier: Apache-2.0
// What an expression of SPARQL computes with: a term of the store seen as its value, or a computed value.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "cluxel/knowledge/quad_store.hpp"
#include "sparql/calendar.hpp"
#include "sparql/decimal.hpp"

namespace cluxel::sparql {

/// A term within one query: below kFirstComputed the store's id, from there on a term the query itself made; 0 unbound.
using ValueId = std::uint32_t;
inline constexpr ValueId kUnbound = 0;
inline constexpr ValueId kFirstComputed = 0x8000'0000u;

/// Text of a computed string, IRI or blank node, with the language of a langString.
struct TextPayload {
  std::string text, language;
};

/// Small enough to be passed by value. A value that came from a term keeps the term's id and so its lexical form; a
/// computed one has no id and the canonical lexical form.
struct Value {
  enum class Type : std::uint8_t {
    None,  ///< unbound, or the outcome of an error
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
  using Payload = std::variant<TextPayload, sparql::Decimal, CalendarTime, sparql::Duration>;

  Type type = Type::None;
  CalendarKind calendar = CalendarKind::DateTime;
  static constexpr std::uint8_t kNoScale = DecodedValue::kNoScale;
  std::uint8_t scale = 0;  ///< of a Decimal without payload: it is integer * 10^-scale; kNoScale: only its term tells
  ValueId id = kUnbound;
  std::int64_t integer = 0;  ///< Boolean, Integer without payload; the digits of a Decimal without payload
  double number = 0;         ///< the value of Float and Double; near the value of Integer and Decimal
  std::shared_ptr<const Payload> payload;  ///< of computed texts, of calendar values, of exact and great numbers

  bool isError() const { return type == Type::None; }
  explicit operator bool() const { return type != Type::None; }
  bool isNumeric() const { return type >= Type::Integer && type <= Type::Double; }
  bool isLiteral() const { return type >= Type::Boolean; }
  bool isStringLike() const { return type == Type::String || type == Type::LangString; }
  bool isCalendar() const { return type >= Type::DateTime && type <= Type::Calendar; }
  bool isDuration() const { return type >= Type::Duration && type <= Type::YearMonthDuration; }

  /// The number of an Integer or Decimal whose scale is known.
  sparql::Decimal exact() const;

  static Value boolean(bool value);
  static Value ofInteger(std::int64_t value);
  static Value ofInteger(const sparql::Decimal& whole);
  static Value ofDecimal(sparql::Decimal value);
  static Value ofFloat(float value);
  static Value ofDouble(double value);
  static Value string(std::string text);
  static Value langString(std::string text, std::string language);
  static Value iri(std::string text);
  static Value blank(std::string label);
  static Value ofCalendar(CalendarKind kind, CalendarTime time);
  static Value ofDuration(DurationKind kind, sparql::Duration duration);
};

/// The value of a term by its lexical form and datatype; without id.
Value valueOfTerm(TermKind kind, std::string_view text, std::string_view datatype, std::string_view language);
inline Value valueOfTerm(const Term& term) {
  return valueOfTerm(term.kind, term.text, term.datatype, term.language);
}

/// The term of a computed value (not of one with only an id), with the canonical lexical form.
Term termOfComputed(const Value& value);

/// XSD 1.1 canonical forms ("1.0E0", "INF"), the shortest digits that read back the same.
std::string canonicalText(double value);
std::string canonicalText(float value);
/// The lexical space of xsd:double and xsd:float; nothing for other text.
std::optional<double> parseDouble(std::string_view text);
std::optional<float> parseFloat(std::string_view text);
/// xsd:boolean.
std::optional<bool> parseBoolean(std::string_view text);
/// Text without XML white space at both ends.
std::string_view trimmed(std::string_view text);

}  // namespace cluxel::sparql
