// SPDX-License-Identifier: Apache-2.0
// Exact decimal numbers over Boost's integers.
#include "sparql/decimal.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace cluxel::sparql {
namespace {

using Integer = Decimal::Integer;

Integer powerOfTen(unsigned exponent) { return boost::multiprecision::pow(Integer(10), exponent); }

bool isTooLong(const Integer& value) {
  // 3.33 bits make a digit.
  return value != 0 && boost::multiprecision::msb(abs(value)) > Decimal::kMaxDigits * 10 / 3;
}

std::optional<Decimal> checked(Decimal value, const Integer& size) {
  if (isTooLong(size)) return std::nullopt;
  return value;
}

/// The quotient rounded towards minus infinity.
Integer floorDivide(const Integer& a, const Integer& b) {
  Integer quotient, remainder;
  boost::multiprecision::divide_qr(a, b, quotient, remainder);
  if (remainder != 0 && ((remainder < 0) != (b < 0))) --quotient;
  return quotient;
}

}  // namespace

Decimal::Decimal(Integer unscaled, unsigned scale) : unscaled_(std::move(unscaled)), scale_(scale) { normalise(); }

void Decimal::normalise() {
  if (unscaled_ == 0) scale_ = 0;
  while (scale_ > 0) {
    Integer quotient, remainder;
    boost::multiprecision::divide_qr(unscaled_, Integer(10), quotient, remainder);
    if (remainder != 0) return;
    unscaled_ = std::move(quotient);
    --scale_;
  }
}

std::optional<Decimal> Decimal::parse(std::string_view text) {
  const bool negative = !text.empty() && text.front() == '-';
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  std::string digits;
  unsigned scale = 0;
  bool point = false;
  for (const char c : text) {
    if (c == '.') {
      if (point) return std::nullopt;
      point = true;
    } else if (c >= '0' && c <= '9') {
      digits += c;
      scale += point ? 1 : 0;
    } else {
      return std::nullopt;
    }
  }
  if (digits.empty() || digits.size() > kMaxDigits) return std::nullopt;
  // A leading zero would make Boost read octal digits.
  digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size() - 1));
  Integer value(digits);
  return Decimal(negative ? Integer(-value) : std::move(value), scale);
}

std::optional<Decimal> Decimal::fromDouble(double value) {
  if (!std::isfinite(value)) return std::nullopt;
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  const Integer whole(static_cast<std::int64_t>(std::ldexp(mantissa, 53)));
  exponent -= 53;
  if (exponent >= 0) return Decimal(Integer(whole << exponent));
  // x / 2^k = x * 5^k / 10^k
  const auto k = static_cast<unsigned>(-exponent);
  return Decimal(Integer(whole * boost::multiprecision::pow(Integer(5), k)), k);
}

std::optional<std::int64_t> Decimal::toInt64() const {
  if (scale_ != 0 || unscaled_ > INT64_MAX || unscaled_ < INT64_MIN) return std::nullopt;
  return static_cast<std::int64_t>(unscaled_);
}

double Decimal::toDouble() const { return std::strtod(text().c_str(), nullptr); }
float Decimal::toFloat() const { return std::strtof(text().c_str(), nullptr); }

Integer Decimal::truncated() const { return scale_ == 0 ? unscaled_ : Integer(unscaled_ / powerOfTen(scale_)); }

std::string Decimal::text(bool point) const {
  std::string digits = Integer(abs(unscaled_)).str();
  if (digits.size() <= scale_) digits.insert(0, scale_ + 1 - digits.size(), '0');
  if (scale_ > 0) digits.insert(digits.size() - scale_, 1, '.');
  if (scale_ == 0 && point) digits += ".0";
  return isNegative() ? "-" + digits : digits;
}

Decimal Decimal::operator-() const {
  Decimal result = *this;
  result.unscaled_ = -result.unscaled_;
  return result;
}

Decimal Decimal::floor() const { return Decimal(floorDivide(unscaled_, powerOfTen(scale_))); }
Decimal Decimal::ceiling() const { return -(-*this).floor(); }

Decimal Decimal::round() const {
  if (scale_ == 0) return *this;
  const Integer unit = powerOfTen(scale_);
  return Decimal(floorDivide(Integer(unscaled_ * 2 + unit), Integer(unit * 2)));
}

Integer Decimal::scaledTo(unsigned scale) const { return unscaled_ * powerOfTen(scale - scale_); }

std::optional<Decimal> Decimal::add(const Decimal& a, const Decimal& b) {
  const unsigned scale = std::max(a.scale_, b.scale_);
  const Integer sum = a.scaledTo(scale) + b.scaledTo(scale);
  return checked(Decimal(sum, scale), sum);
}

std::optional<Decimal> Decimal::subtract(const Decimal& a, const Decimal& b) { return add(a, -b); }

std::optional<Decimal> Decimal::multiply(const Decimal& a, const Decimal& b) {
  const Integer product = a.unscaled_ * b.unscaled_;
  if (isTooLong(product) || a.scale_ + b.scale_ > kMaxDigits) return std::nullopt;
  return Decimal(product, a.scale_ + b.scale_);
}

std::optional<Decimal> Decimal::divide(const Decimal& a, const Decimal& b) {
  if (b.isZero()) return std::nullopt;
  // Enough digits that the quotient keeps kDivisionDigits behind the point, and as many significant ones.
  unsigned digits = kDivisionDigits;
  const auto lengthOf = [](const Integer& value) { return Integer(abs(value)).str().size(); };
  const auto integer_digits = static_cast<long>(lengthOf(a.unscaled_)) - static_cast<long>(a.scale_) -
                              (static_cast<long>(lengthOf(b.unscaled_)) - static_cast<long>(b.scale_));
  if (integer_digits < 0) digits += static_cast<unsigned>(-integer_digits);
  if (digits > kMaxDigits) return std::nullopt;
  const unsigned shift = digits + b.scale_;
  // value = (a.unscaled / 10^a.scale) / (b.unscaled / 10^b.scale), cut after `digits` digits.
  const Integer numerator = a.unscaled_ * powerOfTen(shift);
  const Integer denominator = b.unscaled_ * powerOfTen(a.scale_);
  return Decimal(Integer(numerator / denominator), digits);
}

std::strong_ordering Decimal::operator<=>(const Decimal& other) const {
  const unsigned scale = std::max(scale_, other.scale_);
  const int order = scaledTo(scale).compare(other.scaledTo(scale));
  return order < 0 ? std::strong_ordering::less
                   : order > 0 ? std::strong_ordering::greater : std::strong_ordering::equal;
}

}  // namespace cluxel::sparql
