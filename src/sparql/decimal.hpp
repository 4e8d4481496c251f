// SPDX-License-Identifier: Apache-2.0
// Exact decimal numbers: the values of xsd:decimal and xsd:integer of any size.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace cluxel::sparql {

/// unscaled * 10^-scale, with the least scale that holds the value; so equal values have equal members. Where the
/// unscaled number fits 64 bits, as coordinates and heights do, everything but division stays in machine words.
/// Numbers grow to at most kMaxDigits digits: beyond it the operations give nothing, which is a type error in SPARQL.
class Decimal {
 public:
  using Integer = boost::multiprecision::cpp_int;
  static constexpr unsigned kMaxDigits = 2000;
  static constexpr unsigned kDivisionDigits = 18;  ///< fraction digits of a quotient that does not end

  Decimal() = default;
  explicit Decimal(std::int64_t value) : small_(value) {}
  explicit Decimal(const Integer& value) : Decimal(value, 0) {}
  Decimal(std::int64_t unscaled, unsigned scale);
  Decimal(const Integer& unscaled, unsigned scale);

  /// Optional sign, digits, optional point and digits (xsd:decimal); nothing for anything else.
  static std::optional<Decimal> parse(std::string_view text);
  /// The exact value of a finite double.
  static std::optional<Decimal> fromDouble(double value);

  bool isInteger() const { return scale_ == 0; }
  bool isZero() const { return !great_ && small_ == 0; }
  bool isNegative() const { return great_ ? *great_ < 0 : small_ < 0; }
  /// Whether unscaled() and scale() say it all.
  bool isSmall() const { return !great_; }
  std::int64_t unscaled() const { return small_; }
  unsigned scale() const { return scale_; }
  std::optional<std::int64_t> toInt64() const;  ///< nothing for fractions and greater numbers
  double toDouble() const;                      ///< the nearest double
  float toFloat() const;
  Integer truncated() const;
  std::string integerText() const { return truncated().str(); }
  /// As xsd 1.1 prints decimals: no point for whole numbers when `point` is false, else "1.0".
  std::string text(bool point = false) const;

  Decimal operator-() const;
  Decimal floor() const;
  Decimal ceiling() const;
  Decimal round() const;  ///< halves go up, as fn:round says

  static std::optional<Decimal> add(const Decimal& a, const Decimal& b);
  static std::optional<Decimal> subtract(const Decimal& a, const Decimal& b);
  static std::optional<Decimal> multiply(const Decimal& a, const Decimal& b);
  /// Nothing for a zero divisor. A quotient that does not end is cut after kDivisionDigits fraction digits, or after as
  /// many significant ones when it is smaller than that.
  static std::optional<Decimal> divide(const Decimal& a, const Decimal& b);

  std::strong_ordering operator<=>(const Decimal& other) const;
  bool operator==(const Decimal& other) const { return (*this <=> other) == 0; }

 private:
  Integer whole() const { return great_ ? *great_ : Integer(small_); }  ///< the unscaled number
  /// The unscaled number at a greater scale, where 64 bits hold it.
  bool smallAt(unsigned scale, std::int64_t& out) const;
  Integer scaledTo(unsigned scale) const;

  std::int64_t small_ = 0;
  unsigned scale_ = 0;
  std::shared_ptr<const Integer> great_;  ///< in place of small_ where 64 bits do not hold it
};

}  // namespace cluxel::sparql
