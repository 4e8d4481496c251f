// SPDX-License-Identifier: Apache-2.0
// Exact decimal numbers: the values of xsd:decimal and xsd:integer of any size.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cluxel::sparql {

/// unscaled * 10^-scale, with the least scale that holds the value; so equal values have equal members.
/// Numbers grow to at most kMaxDigits digits: beyond it the operations give nothing, which is a type error in SPARQL.
class Decimal {
 public:
  using Integer = boost::multiprecision::cpp_int;
  static constexpr unsigned kMaxDigits = 2000;
  static constexpr unsigned kDivisionDigits = 18;   ///< fraction digits of a quotient that does not end

  Decimal() = default;
  explicit Decimal(std::int64_t value) : unscaled_(value) {}
  explicit Decimal(Integer value) : unscaled_(std::move(value)) {}
  Decimal(Integer unscaled, unsigned scale);

  /// Optional sign, digits, optional point and digits (xsd:decimal); nothing for anything else.
  static std::optional<Decimal> parse(std::string_view text);
  /// The exact value of a finite double.
  static std::optional<Decimal> fromDouble(double value);

  bool isInteger() const { return scale_ == 0; }
  bool isZero() const { return unscaled_ == 0; }
  bool isNegative() const { return unscaled_ < 0; }
  std::optional<std::int64_t> toInt64() const;   ///< nothing for fractions and greater numbers
  double toDouble() const;                       ///< the nearest double
  float toFloat() const;
  Integer truncated() const;
  std::string integerText() const { return truncated().str(); }
  /// As xsd 1.1 prints decimals: no point for whole numbers when `point` is false, else "1.0".
  std::string text(bool point = false) const;

  Decimal operator-() const;
  Decimal floor() const;
  Decimal ceiling() const;
  Decimal round() const;   ///< halves go up, as fn:round says

  static std::optional<Decimal> add(const Decimal& a, const Decimal& b);
  static std::optional<Decimal> subtract(const Decimal& a, const Decimal& b);
  static std::optional<Decimal> multiply(const Decimal& a, const Decimal& b);
  /// Nothing for a zero divisor. A quotient that does not end is cut after kDivisionDigits fraction digits, or after as
  /// many significant ones when it is smaller than that.
  static std::optional<Decimal> divide(const Decimal& a, const Decimal& b);

  std::strong_ordering operator<=>(const Decimal& other) const;
  bool operator==(const Decimal& other) const { return scale_ == other.scale_ && unscaled_ == other.unscaled_; }

 private:
  void normalise();
  Integer scaledTo(unsigned scale) const;

  Integer unscaled_ = 0;
  unsigned scale_ = 0;
};

}  // namespace cluxel::sparql
