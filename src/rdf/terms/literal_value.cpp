// SPDX-License-Identifier: Apache-2.0
// Decodes numbers and booleans; dates are in literal_date.cpp.
#include "rdf/terms/literal_value.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "base/ascii.hpp"
#include "rdf/terms/literal_date.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

using Type = DecodedValue::Type;

std::string_view withoutPlus(std::string_view text) {
  if (text.starts_with('+') && text.size() > 1 && text[1] != '-') text.remove_prefix(1);
  return text;
}

std::optional<std::int64_t> parseInteger(std::string_view lexical) {
  const std::string_view text = withoutPlus(lexical);
  std::int64_t value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc{} || end.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Out of the range of double: infinity or zero, decided by the position of the first digit.
double saturate(std::string_view text) {
  const bool negative = text.starts_with('-');
  const std::size_t e = text.find_first_of("eE");
  const std::string_view mantissa = text.substr(0, e);
  long exponent = 0;
  if (e != std::string_view::npos) {
    const std::string_view digits = withoutPlus(text.substr(e + 1));
    const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
    if (end.ec == std::errc::result_out_of_range) exponent = digits.starts_with('-') ? -1'000'000'000 : 1'000'000'000;
  }
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t first = mantissa.find_first_of("123456789");
  const bool large =
      first != std::string_view::npos && static_cast<long>(point) - static_cast<long>(first) + exponent > 0;
  const double magnitude = large ? std::numeric_limits<double>::infinity() : 0.0;
  return negative ? -magnitude : magnitude;
}

/// Digits with at most one point, and an exponent if `exponent_allowed`.
bool isNumber(std::string_view text, bool exponent_allowed) {
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  std::size_t i = 0;
  std::size_t digits = 0;
  for (bool point = false; i < text.size() && (isAsciiDigit(text[i]) || (text[i] == '.' && !point)); ++i) {
    point = point || text[i] == '.';
    digits += isAsciiDigit(text[i]) ? 1 : 0;
  }
  if (digits == 0 || i == text.size()) return digits > 0;
  if (!exponent_allowed || (text[i] != 'e' && text[i] != 'E')) return false;
  if (++i < text.size() && (text[i] == '-' || text[i] == '+')) ++i;
  if (i == text.size()) return false;
  for (; i < text.size(); ++i)
    if (!isAsciiDigit(text[i])) return false;
  return true;
}

double parseNumber(std::string_view lexical) {
  const std::string_view text = withoutPlus(lexical);
  double value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  return end.ec == std::errc::result_out_of_range ? saturate(text) : value;
}

std::optional<double> parseDouble(std::string_view lexical) {
  if (lexical == "INF" || lexical == "+INF") return std::numeric_limits<double>::infinity();
  if (lexical == "-INF") return -std::numeric_limits<double>::infinity();
  if (lexical == "NaN") return std::numeric_limits<double>::quiet_NaN();
  if (!isNumber(lexical, true)) return std::nullopt;
  return parseNumber(lexical);
}

/// The float nearest to the decimal form; rounding to double first would round twice.
double parseFloat(std::string_view lexical, double as_double) {
  const std::string_view text = withoutPlus(lexical);
  float value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  return end.ec == std::errc{} && std::isfinite(as_double) ? value : static_cast<float>(as_double);
}

struct IntegerType {
  std::string_view name;
  std::int64_t min, max;
};

constexpr std::int64_t kMinInteger = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kMaxInteger = std::numeric_limits<std::int64_t>::max();
constexpr std::array<IntegerType, 13> kIntegerTypes = {{
    {"integer", kMinInteger, kMaxInteger},
    {"int", -2147483648LL, 2147483647LL},
    {"long", kMinInteger, kMaxInteger},
    {"short", -32768, 32767},
    {"byte", -128, 127},
    {"nonNegativeInteger", 0, kMaxInteger},
    {"positiveInteger", 1, kMaxInteger},
    {"nonPositiveInteger", kMinInteger, 0},
    {"negativeInteger", kMinInteger, -1},
    {"unsignedLong", 0, kMaxInteger},
    {"unsignedInt", 0, 4294967295LL},
    {"unsignedShort", 0, 65535},
    {"unsignedByte", 0, 255},
}};

DecodedValue numberOf(Type type, std::optional<double> value) {
  DecodedValue decoded;
  decoded.kind = TermKind::Literal;
  if (!value) return decoded;
  decoded.type = type;
  decoded.number = *value;
  return decoded;
}

DecodedValue integerOf(Type type, std::optional<std::int64_t> value) {
  DecodedValue decoded = numberOf(type, value ? std::optional(static_cast<double>(*value)) : std::nullopt);
  if (value) decoded.integer = *value;
  return decoded;
}

DecodedValue momentOf(Type type, std::optional<std::int64_t> microseconds) {
  DecodedValue decoded = integerOf(type, microseconds);
  decoded.number /= 1e6;
  return decoded;
}

DecodedValue decodeInteger(std::string_view lexical, std::string_view name) {
  for (const IntegerType& type : kIntegerTypes) {
    if (type.name != name) continue;
    const std::optional<std::int64_t> value = parseInteger(lexical);
    if (value && (*value < type.min || *value > type.max)) break;
    return integerOf(Type::Integer, value);
  }
  return numberOf(Type::None, std::nullopt);
}

std::optional<std::int64_t> parseBoolean(std::string_view lexical) {
  if (lexical == "true" || lexical == "1") return 1;
  if (lexical == "false" || lexical == "0") return 0;
  return std::nullopt;
}

}  // namespace

DecodedValue decodeLiteral(std::string_view lexical, std::string_view datatype) {
  if (!datatype.starts_with(vocabulary::kXsd)) {
    const bool tagged = datatype == vocabulary::rdf("langString");
    return numberOf(tagged ? Type::LangString : Type::None, tagged ? std::optional(0.0) : std::nullopt);
  }
  const std::string_view name = datatype.substr(vocabulary::kXsd.size());
  if (name == "string") return numberOf(Type::String, 0.0);
  if (name == "double") return numberOf(Type::Double, parseDouble(lexical));
  if (name == "decimal")
    return numberOf(Type::Decimal, isNumber(lexical, false) ? std::optional(parseNumber(lexical)) : std::nullopt);
  if (name == "float") {
    const std::optional<double> value = parseDouble(lexical);
    return numberOf(Type::Float, value ? std::optional(parseFloat(lexical, *value)) : std::nullopt);
  }
  if (name == "boolean") return integerOf(Type::Boolean, parseBoolean(lexical));
  if (name == "dateTime") return momentOf(Type::DateTime, parseMicroseconds(CalendarKind::DateTime, lexical));
  if (name == "date") return momentOf(Type::Date, parseMicroseconds(CalendarKind::Date, lexical));
  return decodeInteger(lexical, name);
}

void addExactDigits(std::string_view lexical, DecodedValue& value) {
  constexpr std::size_t max_digits = 18;  // which always fit 64 bits
  const bool is_negative = lexical.starts_with('-');
  if (is_negative || lexical.starts_with('+')) lexical.remove_prefix(1);
  const std::size_t point = lexical.find('.');
  const std::size_t fraction = point == std::string_view::npos ? 0 : lexical.size() - point - 1;
  if (lexical.size() - (point == std::string_view::npos ? 0 : 1) > max_digits) return;
  std::int64_t digits = 0;
  for (const char c : lexical) {
    if (c == '.') continue;
    if (c < '0' || c > '9') return;
    digits = digits * 10 + (c - '0');
  }
  value.integer = is_negative ? -digits : digits;
  value.scale = static_cast<std::uint8_t>(fraction);
}

}  // namespace cluxel::rdf
