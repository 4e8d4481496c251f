// SPDX-License-Identifier: Apache-2.0
// Converts between terms and values.
#include "sparql/values/value.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "base/ascii.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/values/datatype.hpp"

namespace cluxel::sparql {
namespace {

template <typename Payload>
std::shared_ptr<const Value::Payload> share(Payload payload) {
  return std::make_shared<const Value::Payload>(std::move(payload));
}

Value ofType(Value::Type type) {
  Value value;
  value.type = type;
  return value;
}

template <typename Real>
std::string canonicalReal(Real value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value < 0 ? "-INF" : "INF";
  std::array<char, 64> buffer{};
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific).ptr;
  const std::string_view text(buffer.data(), static_cast<std::size_t>(end - buffer.data()));
  const std::size_t e = text.find('e');
  std::string mantissa(text.substr(0, e));
  if (mantissa.find('.') == std::string::npos) mantissa += ".0";
  int exponent = 0;
  const char* digits = text.data() + e + 1;
  if (*digits == '+') ++digits;
  std::from_chars(digits, end, exponent);
  return mantissa + "E" + std::to_string(exponent);
}

/// For an out-of-range number: true for underflow, decided by the position of the first digit.
bool isTiny(std::string_view text) {
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  const std::string_view mantissa = text.substr(0, e);
  const std::size_t first = std::min(mantissa.find_first_of("123456789"), e), point = std::min(mantissa.find('.'), e);
  const std::string_view exponent = e < text.size() ? text.substr(e + 1) : std::string_view();
  const bool negative = exponent.starts_with('-');
  long long power = 0;
  for (const char c : exponent) {
    if (c >= '0' && c <= '9') power = std::min(power * 10 + (c - '0'), 1'000'000'000'000LL);
  }
  return static_cast<long long>(point) - static_cast<long long>(first) + (negative ? -power : power) < 0;
}

template <typename Real>
std::optional<Real> parseReal(std::string_view text) {
  if (text == "INF" || text == "+INF") return std::numeric_limits<Real>::infinity();
  if (text == "-INF") return -std::numeric_limits<Real>::infinity();
  if (text == "NaN") return std::numeric_limits<Real>::quiet_NaN();
  if (!text.empty() && text.front() == '+') {
    text.remove_prefix(1);
    if (!text.empty() && text.front() == '-') return std::nullopt;
  }
  // from_chars also accepts "inf" and "nan".
  if (text.find_first_not_of("0123456789.eE+-") != std::string_view::npos) return std::nullopt;
  Real value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || text.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    const Real size = isTiny(text) ? Real(0) : std::numeric_limits<Real>::infinity();
    return text.front() == '-' ? -size : size;
  }
  if (error != std::errc{}) return std::nullopt;
  return value;
}

Value integerOf(std::string_view text, const DatatypeInfo& info) {
  if (text.find('.') != std::string_view::npos) return ofType(Value::Type::Other);
  const auto number = Decimal::parse(text);
  if (!number || !info.inRange(*number)) return ofType(Value::Type::Other);
  return Value::ofInteger(*number);
}

Value literalValue(std::string_view text, const DatatypeInfo& info) {
  const std::string_view bare = trimmed(text);
  switch (info.type) {
    case Value::Type::Boolean:
      if (const auto value = parseBoolean(bare)) return Value::boolean(*value);
      break;
    case Value::Type::Integer:
      return integerOf(bare, info);
    case Value::Type::Decimal:
      if (auto value = Decimal::parse(bare)) return Value::ofDecimal(std::move(*value));
      break;
    case Value::Type::Float:
      if (const auto value = parseFloat(bare)) return Value::ofFloat(*value);
      break;
    case Value::Type::Double:
      if (const auto value = parseDouble(bare)) return Value::ofDouble(*value);
      break;
    case Value::Type::String:
      return Value::string(std::string(text));
    case Value::Type::DateTime:
    case Value::Type::Date:
    case Value::Type::Time:
    case Value::Type::Calendar:
      if (auto value = parseCalendar(info.calendar, bare)) return Value::ofCalendar(info.calendar, std::move(*value));
      break;
    case Value::Type::Duration:
    case Value::Type::DayTimeDuration:
    case Value::Type::YearMonthDuration:
      if (auto value = parseDuration(durationKind(info.type), bare)) {
        return Value::ofDuration(durationKind(info.type), std::move(*value));
      }
      break;
    default:
      break;
  }
  return ofType(Value::Type::Other);
}

}  // namespace

Value Value::boolean(bool value) {
  Value result = ofType(Type::Boolean);
  result.integer = value ? 1 : 0;
  return result;
}

Value Value::ofInteger(std::int64_t value) {
  Value result = ofType(Type::Integer);
  result.integer = value;
  result.number = static_cast<double>(value);
  return result;
}

Value Value::ofInteger(const Decimal& whole) {
  if (const auto small = whole.toInt64()) return ofInteger(*small);
  Value result = ofType(Type::Integer);
  result.number = whole.toDouble();
  result.payload = share(whole);
  return result;
}

Value Value::ofDecimal(Decimal value) {
  Value result = ofType(Type::Decimal);
  result.number = value.toDouble();
  if (value.isSmall() && value.scale() < kNoScale) {
    result.integer = value.unscaled();
    result.scale = static_cast<std::uint8_t>(value.scale());
  } else {
    result.payload = share(std::move(value));
  }
  return result;
}

Decimal Value::exact() const {
  if (payload) return std::get<Decimal>(*payload);
  return {integer, scale};
}

Value Value::ofFloat(float value) {
  Value result = ofType(Type::Float);
  result.number = static_cast<double>(value);
  return result;
}

Value Value::ofDouble(double value) {
  Value result = ofType(Type::Double);
  result.number = value;
  return result;
}

Value Value::string(std::string text) {
  Value result = ofType(Type::String);
  result.payload = share(TextPayload{std::move(text), {}});
  return result;
}

Value Value::langString(std::string text, std::string language) {
  Value result = ofType(Type::LangString);
  result.payload = share(TextPayload{std::move(text), std::move(language)});
  return result;
}

Value Value::iri(std::string text) {
  Value result = ofType(Type::Iri);
  result.payload = share(TextPayload{std::move(text), {}});
  return result;
}

Value Value::blank(std::string label) {
  Value result = ofType(Type::Blank);
  result.payload = share(TextPayload{std::move(label), {}});
  return result;
}

Value Value::ofCalendar(CalendarKind kind, CalendarTime time) {
  Value result = ofType(kind == CalendarKind::DateTime ? Type::DateTime
                        : kind == CalendarKind::Date   ? Type::Date
                        : kind == CalendarKind::Time   ? Type::Time
                                                       : Type::Calendar);
  result.calendar = kind;
  result.payload = share(withoutAbsentParts(kind, std::move(time)));
  return result;
}

Value Value::ofDuration(DurationKind kind, Duration duration) {
  Value result = ofType(kind == DurationKind::Duration  ? Type::Duration
                        : kind == DurationKind::DayTime ? Type::DayTimeDuration
                                                        : Type::YearMonthDuration);
  result.payload = share(std::move(duration));
  return result;
}

Value valueOfTerm(TermKind kind, std::string_view text, std::string_view datatype, std::string_view language) {
  if (kind == TermKind::Iri) return Value::iri(std::string(text));
  if (kind == TermKind::BlankNode) return Value::blank(std::string(text));
  if (!language.empty()) return Value::langString(std::string(text), std::string(language));
  const DatatypeInfo* info = findDatatype(datatype);
  return info == nullptr ? ofType(Value::Type::Other) : literalValue(text, *info);
}

Term termOfComputed(const Value& value) {
  using Type = Value::Type;
  const auto text = [&]() -> const TextPayload& { return std::get<TextPayload>(*value.payload); };
  const std::string_view datatype = datatypeIri(value);
  switch (value.type) {
    case Type::Iri:
      return Term::iri(text().text);
    case Type::Blank:
      return Term::blank(text().text);
    case Type::String:
      return Term::literal(text().text);
    case Type::LangString:
      return Term::langLiteral(text().text, text().language);
    case Type::Boolean:
      return Term::literal(value.integer != 0 ? "true" : "false", datatype);
    case Type::Integer:
    case Type::Decimal:
      return Term::literal(value.exact().text(), datatype);
    case Type::Float:
      return Term::literal(canonicalText(static_cast<float>(value.number)), datatype);
    case Type::Double:
      return Term::literal(canonicalText(value.number), datatype);
    case Type::DateTime:
    case Type::Date:
    case Type::Time:
    case Type::Calendar:
      return Term::literal(formatCalendar(value.calendar, std::get<CalendarTime>(*value.payload)), datatype);
    case Type::Duration:
    case Type::DayTimeDuration:
    case Type::YearMonthDuration:
      return Term::literal(formatDuration(durationKind(value.type), std::get<Duration>(*value.payload)), datatype);
    case Type::None:
    case Type::Other:
      break;
  }
  return {};
}

std::string canonicalText(double value) {
  return canonicalReal(value);
}
std::string canonicalText(float value) {
  return canonicalReal(value);
}
std::optional<double> parseDouble(std::string_view text) {
  return parseReal<double>(text);
}
std::optional<float> parseFloat(std::string_view text) {
  return parseReal<float>(text);
}

std::optional<bool> parseBoolean(std::string_view text) {
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  return std::nullopt;
}

}  // namespace cluxel::sparql
