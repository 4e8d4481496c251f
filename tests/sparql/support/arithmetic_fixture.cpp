// SPDX-License-Identifier: Apache-2.0
// The reference: rational numbers for integers and decimals, hardware arithmetic for float and double.
#include "sparql/support/arithmetic_fixture.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace cluxel::test {

using boost::multiprecision::cpp_int;
using boost::multiprecision::cpp_rational;

std::string randomDecimalText(std::mt19937_64& random) {
  std::string text = random() % 2 == 0 ? "-" : "";
  const auto digits = [&](std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) text += static_cast<char>('0' + random() % 10);
  };
  // Short numbers, and numbers near the limit of 64 bits, which are computed differently.
  const bool is_short = random() % 2 == 0;
  digits(1 + random() % (is_short ? 4 : 20));
  if (random() % 3 == 0) return text;
  text += ".";
  digits(1 + random() % (is_short ? 3 : 15));
  return text;
}

cpp_rational rationalOf(const std::string& text) {
  cpp_int digits = 0, unit = 1;
  bool point = false;
  for (const char c : text) {
    if (c == '.') point = true;
    if (c < '0' || c > '9') continue;
    digits = digits * 10 + (c - '0');
    if (point) unit *= 10;
  }
  return cpp_rational(text.starts_with("-") ? cpp_int(-digits) : digits, unit);
}

namespace {

/// The decimal text of a rational with a finite expansion.
std::string decimalText(cpp_rational value) {
  const bool negative = value < 0;
  if (negative) value = -value;
  cpp_int whole = numerator(value) / denominator(value);
  cpp_rational rest = value - whole;
  std::string text = (negative && value != 0 ? "-" : "") + whole.str();
  if (rest == 0) return text;
  text += ".";
  while (rest != 0) {
    rest *= 10;
    const cpp_int digit = numerator(rest) / denominator(rest);
    text += digit.str();
    rest -= digit;
  }
  return text;
}

std::string doubleText(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value < 0 ? "-INF" : "INF";
  std::array<char, 64> buffer{};
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific).ptr;
  std::string text(buffer.data(), end);
  const std::size_t e = text.find('e');
  std::string mantissa = text.substr(0, e);
  if (mantissa.find('.') == std::string::npos) mantissa += ".0";
  return mantissa + "E" + std::to_string(std::stoi(text.substr(e + 1)));
}

}  // namespace

RandomSum randomSum(std::mt19937_64& random) {
  constexpr std::array<char, 3> kOperators = {'+', '-', '*'};
  const char op = kOperators[random() % 3];
  const auto combine = [op]<typename Number>(const Number& a, const Number& b) {
    return op == '+' ? Number(a + b) : op == '-' ? Number(a - b) : Number(a * b);
  };
  const auto typed = [](const std::string& text, const char* type) { return "\"" + text + "\"^^xsd:" + type; };
  const std::string a = randomDecimalText(random);
  if (random() % 2 == 0) {
    const std::string b = randomDecimalText(random);
    const bool integers = a.find('.') == std::string::npos && b.find('.') == std::string::npos;
    const auto type = [](const std::string& text) {
      return text.find('.') == std::string::npos ? "integer" : "decimal";
    };
    const cpp_rational result = combine(rationalOf(a), rationalOf(b));
    return {typed(a, type(a)) + " " + op + " " + typed(b, type(b)),
            "\"" + decimalText(result) + "\"^^" + (integers ? "integer" : "decimal")};
  }
  const double x = std::strtod(a.c_str(), nullptr);
  const double y = std::ldexp(static_cast<double>(random() % 1'000'000'007), static_cast<int>(random() % 200) - 100);
  const std::string first = a.find('.') == std::string::npos ? typed(a, "integer") : typed(a, "decimal");
  return {first + " " + op + " " + typed(doubleText(y), "double"), "\"" + doubleText(combine(x, y)) + "\"^^double"};
}

}  // namespace cluxel::test
