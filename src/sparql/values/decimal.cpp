// SPDX-License-Identifier: Apache-2.0
// Exact decimal arithmetic with Boost.Multiprecision.
#include "sparql/values/decimal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace cluxel::sparql {
namespace {

using Integer = Decimal::Integer;

constexpr std::size_t kSmallDigits = 18;  // which always fit 64 bits

/// The powers of ten that fit 64 bits.
constexpr auto kTens = [] {
  std::array<std::int64_t, kSmallDigits + 1> tens{};
  tens[0] = 1;
  for (std::size_t i = 1; i < tens.size(); ++i) tens[i] = tens[i - 1] * 10;
  return tens;
}();

Integer powerOfTen(unsigned exponent) {
  return boost::multiprecision::pow(Integer(10), exponent);
}

bool isTooLong(const Integer& value) {
  // A digit needs 3.33 bits.
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

Decimal::Decimal(std::int64_t unscaled, unsigned scale) : small_(unscaled), scale_(unscaled == 0 ? 0 : scale) {
  while (scale_ > 0 && small_ % 10 == 0) {
    small_ /= 10;
    --scale_;
  }
}

Decimal::Decimal(const Integer& unscaled, unsigned scale) {
  Integer left = unscaled, quotient, remainder;
  while (scale > 0 && (left > INT64_MAX || left < INT64_MIN)) {
    boost::multiprecision::divide_qr(left, Integer(10), quotient, remainder);
    if (remainder != 0) break;
    left = std::move(quotient);
    --scale;
  }
  if (left <= INT64_MAX && left >= INT64_MIN) {
    *this = Decimal(static_cast<std::int64_t>(left), scale);
    return;
  }
  scale_ = scale;
  great_ = std::make_shared<const Integer>(std::move(left));
}

std::optional<Decimal> Decimal::parse(std::string_view text) {
  const bool negative = !text.empty() && text.front() == '-';
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  std::int64_t small = 0;
  unsigned scale = 0;
  std::size_t digits = 0;
  bool point = false;
  for (const char c : text) {
    if (c == '.') {
      if (point) return std::nullopt;
      point = true;
      continue;
    }
    if (c < '0' || c > '9') return std::nullopt;
    if (++digits <= kSmallDigits) small = small * 10 + (c - '0');
    scale += point ? 1 : 0;
  }
  if (digits == 0 || digits > kMaxDigits) return std::nullopt;
  if (digits <= kSmallDigits) return Decimal(negative ? -small : small, scale);
  std::string plain;
  std::copy_if(text.begin(), text.end(), std::back_inserter(plain), [](char c) { return c != '.'; });
  // Boost parses a leading zero as octal.
  plain.erase(0, std::min(plain.find_first_not_of('0'), plain.size() - 1));
  const Integer value(plain);
  return Decimal(negative ? Integer(-value) : value, scale);
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
  if (scale_ != 0 || great_) return std::nullopt;
  return small_;
}

double Decimal::toDouble() const {
  // Both operands are exact doubles, so the division rounds once.
  constexpr std::int64_t kExact = std::int64_t{1} << 53;
  if (!great_ && scale_ < kTens.size() && small_ <= kExact && small_ >= -kExact) {
    return static_cast<double>(small_) / static_cast<double>(kTens[scale_]);
  }
  return std::strtod(text().c_str(), nullptr);
}

Integer Decimal::truncated() const {
  return scale_ == 0 ? whole() : Integer(whole() / powerOfTen(scale_));
}

std::string Decimal::text(bool point) const {
  // The absolute value of the minimum integer fits only an unsigned type.
  const std::uint64_t size = small_ < 0 ? 0 - static_cast<std::uint64_t>(small_) : static_cast<std::uint64_t>(small_);
  std::string digits = great_ ? Integer(abs(*great_)).str() : std::to_string(size);
  if (digits.size() <= scale_) digits.insert(0, scale_ + 1 - digits.size(), '0');
  if (scale_ > 0) digits.insert(digits.size() - scale_, 1, '.');
  if (scale_ == 0 && point) digits += ".0";
  return isNegative() ? "-" + digits : digits;
}

Decimal Decimal::operator-() const {
  if (great_ || small_ == INT64_MIN) return Decimal(Integer(-whole()), scale_);
  return Decimal(-small_, scale_);
}

Decimal Decimal::floor() const {
  return Decimal(floorDivide(whole(), powerOfTen(scale_)));
}
Decimal Decimal::ceiling() const {
  return -(-*this).floor();
}

Decimal Decimal::round() const {
  if (scale_ == 0) return *this;
  const Integer unit = powerOfTen(scale_);
  return Decimal(floorDivide(Integer(whole() * 2 + unit), Integer(unit * 2)));
}

bool Decimal::smallAt(unsigned scale, std::int64_t& out) const {
  const unsigned shift = scale - scale_;
  return !great_ && shift < kTens.size() && !__builtin_mul_overflow(small_, kTens[shift], &out);
}

Integer Decimal::scaledTo(unsigned scale) const {
  return whole() * powerOfTen(scale - scale_);
}

std::optional<Decimal> Decimal::add(const Decimal& a, const Decimal& b) {
  const unsigned scale = std::max(a.scale_, b.scale_);
  std::int64_t left = 0, right = 0, total = 0;
  if (a.smallAt(scale, left) && b.smallAt(scale, right) && !__builtin_add_overflow(left, right, &total)) {
    return Decimal(total, scale);
  }
  const Integer sum = a.scaledTo(scale) + b.scaledTo(scale);
  return checked(Decimal(sum, scale), sum);
}

std::optional<Decimal> Decimal::subtract(const Decimal& a, const Decimal& b) {
  return add(a, -b);
}

std::optional<Decimal> Decimal::multiply(const Decimal& a, const Decimal& b) {
  const unsigned scale = a.scale_ + b.scale_;
  if (scale > kMaxDigits) return std::nullopt;
  std::int64_t small = 0;
  if (!a.great_ && !b.great_ && !__builtin_mul_overflow(a.small_, b.small_, &small)) return Decimal(small, scale);
  const Integer product = a.whole() * b.whole();
  return checked(Decimal(product, scale), product);
}

std::optional<Decimal> Decimal::divide(const Decimal& a, const Decimal& b) {
  if (b.isZero()) return std::nullopt;
  const Integer left = a.whole(), right = b.whole();
  // Enough digits for kDivisionDigits fraction digits and as many significant digits in the quotient.
  unsigned digits = kDivisionDigits;
  const auto lengthOf = [](const Integer& value) { return Integer(abs(value)).str().size(); };
  const auto integer_digits = static_cast<long>(lengthOf(left)) - static_cast<long>(a.scale_) -
                              (static_cast<long>(lengthOf(right)) - static_cast<long>(b.scale_));
  if (integer_digits < 0) digits += static_cast<unsigned>(-integer_digits);
  if (digits > kMaxDigits) return std::nullopt;
  const unsigned shift = digits + b.scale_;
  // value = (a.unscaled / 10^a.scale) / (b.unscaled / 10^b.scale), cut after `digits` digits.
  const Integer numerator = left * powerOfTen(shift);
  const Integer denominator = right * powerOfTen(a.scale_);
  return Decimal(Integer(numerator / denominator), digits);
}

std::strong_ordering Decimal::operator<=>(const Decimal& other) const {
  const unsigned scale = std::max(scale_, other.scale_);
  std::int64_t left = 0, right = 0;
  if (smallAt(scale, left) && other.smallAt(scale, right)) return left <=> right;
  const int order = scaledTo(scale).compare(other.scaledTo(scale));
  return order < 0   ? std::strong_ordering::less
         : order > 0 ? std::strong_ordering::greater
                     : std::strong_ordering::equal;
}

}  // namespace cluxel::sparql
