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

/// unscaled * 10^-scale with the minimum scale, so that equal values have equal members. If the unscaled number fits 64
/// bits, all operations but division use machine words. Numbers are limited to kMaxDigits digits; beyond that
/// operations return none, which is a type error in SPARQL.
class Decimal {
 public:
  using Integer = boost::multiprecision::cpp_int;
  static constexpr unsigned kMaxDigits = 2000;
  static constexpr unsigned kDivisionDigits = 18;  ///< fraction digits of a non-terminating quotient

  Decimal() = default;
  explicit Decimal(std::int64_t value) : small_(value) {}
  explicit Decimal(const Integer& value) : Decimal(value, 0) {}
  Decimal(std::int64_t unscaled, unsigned scale);
  Decimal(const Integer& unscaled, unsigned scale);

  /// Parses the lexical form of xsd:decimal; none for other text.
  static std::optional<Decimal> parse(std::string_view text);
  /// The exact value of a finite double.
  static std::optional<Decimal> fromDouble(double value);

  bool isZero() const { return !great_ && small_ == 0; }
  bool isNegative() const { return great_ ? *great_ < 0 : small_ < 0; }
  /// True when the value is unscaled() * 10^-scale().
  bool isSmall() const { return !great_; }
  std::int64_t unscaled() const { return small_; }
  unsigned scale() const { return scale_; }
  std::optional<std::int64_t> toInt64() const;  ///< none for fractions and larger numbers
  double toDouble() const;                      ///< the nearest double
  Integer truncated() const;
  /// The canonical form of XSD 1.1; integers are printed as "1" or, with `point`, "1.0".
  std::string text(bool point = false) const;

  Decimal operator-() const;
  Decimal floor() const;
  Decimal ceiling() const;
  Decimal round() const;  ///< rounds half up, as fn:round does

  static std::optional<Decimal> add(const Decimal& a, const Decimal& b);
  static std::optional<Decimal> subtract(const Decimal& a, const Decimal& b);
  static std::optional<Decimal> multiply(const Decimal& a, const Decimal& b);
  /// None for a zero divisor. A non-terminating quotient is truncated after kDivisionDigits fraction digits, or
  /// significant digits for small quotients.
  static std::optional<Decimal> divide(const Decimal& a, const Decimal& b);

  std::strong_ordering operator<=>(const Decimal& other) const;
  bool operator==(const Decimal& other) const { return (*this <=> other) == 0; }

 private:
  Integer whole() const { return great_ ? *great_ : Integer(small_); }  ///< the unscaled number
  /// The unscaled number at a larger scale, if it fits 64 bits.
  bool smallAt(unsigned scale, std::int64_t& out) const;
  Integer scaledTo(unsigned scale) const;

  std::int64_t small_ = 0;
  unsigned scale_ = 0;
  std::shared_ptr<const Integer> great_;  ///< replaces small_ if the number exceeds 64 bits
};

}  // namespace cluxel::sparql
