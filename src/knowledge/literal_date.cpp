// SPDX-License-Identifier: Apache-2.0
// Parsing of dates and times of XML Schema 1.1.
#include "knowledge/literal_date.hpp"

#include <charconv>

namespace cluxel {

namespace {

constexpr std::int64_t kMicro = 1'000'000;
constexpr std::int64_t kDay_s = 86'400;
constexpr int kGreatestYear = 290'000;  // beyond it microseconds do not fit 64 bits

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

/// Reads from the front of a text; every function says whether it found what it wants.
class Reader {
 public:
  explicit Reader(std::string_view text) : rest_(text) {}

  bool character(char c) {
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }

  bool twoDigits(int& value) {
    if (rest_.size() < 2 || !isDigit(rest_[0]) || !isDigit(rest_[1])) return false;
    value = (rest_[0] - '0') * 10 + (rest_[1] - '0');
    rest_.remove_prefix(2);
    return true;
  }

  bool year(int& value) {
    const bool negative = character('-');
    std::size_t digits = 0;
    while (digits < rest_.size() && isDigit(rest_[digits])) ++digits;
    if (digits < 4 || digits > 6 || (digits > 4 && rest_[0] == '0')) return false;
    std::from_chars(rest_.data(), rest_.data() + digits, value);
    rest_.remove_prefix(digits);
    value = negative ? -value : value;
    return value <= kGreatestYear && value >= -kGreatestYear;
  }

  bool fraction(std::int64_t& microseconds) {
    if (!character('.')) return true;
    std::size_t digits = 0;
    std::int64_t unit = kMicro / 10;
    for (; digits < rest_.size() && isDigit(rest_[digits]); ++digits, unit /= 10)
      microseconds += (rest_[digits] - '0') * unit;
    rest_.remove_prefix(digits);
    return digits > 0;
  }

  bool zone(std::int64_t& offset_s) {
    if (character('Z')) return rest_.empty();
    const bool west = character('-');
    if (!west && !character('+')) return false;
    int hours = 0;
    int minutes = 0;
    if (!twoDigits(hours) || !character(':') || !twoDigits(minutes) || !rest_.empty()) return false;
    if (minutes > 59 || hours > 14 || (hours == 14 && minutes > 0)) return false;
    offset_s = (hours * 60 + minutes) * (west ? -60 : 60);
    return true;
  }

  bool atZone() const { return rest_.empty() || rest_.front() == 'Z' || rest_.front() == '+' || rest_.front() == '-'; }

 private:
  std::string_view rest_;
};

int daysIn(int year, int month) {
  if (month == 2) return year % 4 == 0 && (year % 100 != 0 || year % 400 == 0) ? 29 : 28;
  return month == 4 || month == 6 || month == 9 || month == 11 ? 30 : 31;
}

/// Days since 1970-01-01 in the proleptic Gregorian calendar; years are counted from March, in cycles of 400.
std::int64_t dayNumber(int year, int month, int day) {
  const std::int64_t y = month <= 2 ? year - 1 : year;
  const std::int64_t cycle = (y >= 0 ? y : y - 399) / 400;
  const std::int64_t year_of_cycle = y - cycle * 400;
  const std::int64_t day_of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return cycle * 146'097 + year_of_cycle * 365 + year_of_cycle / 4 - year_of_cycle / 100 + day_of_year - 719'468;
}

std::optional<std::int64_t> readDay(Reader& reader) {
  int year = 0;
  int month = 0;
  int day = 0;
  if (!reader.year(year) || !reader.character('-') || !reader.twoDigits(month) || !reader.character('-') ||
      !reader.twoDigits(day))
    return std::nullopt;
  if (month < 1 || month > 12 || day < 1 || day > daysIn(year, month)) return std::nullopt;
  return dayNumber(year, month, day);
}

}  // namespace

std::optional<std::int64_t> parseDateTime(std::string_view lexical) {
  Reader reader(lexical);
  const std::optional<std::int64_t> day = readDay(reader);
  int hour = 0;
  int minute = 0;
  int second = 0;
  std::int64_t micro = 0;
  std::int64_t offset_s = 0;
  if (!day || !reader.character('T') || !reader.twoDigits(hour) || !reader.character(':') ||
      !reader.twoDigits(minute) || !reader.character(':') || !reader.twoDigits(second) || !reader.fraction(micro) ||
      !reader.atZone() || !reader.zone(offset_s))
    return std::nullopt;
  const bool midnight = hour == 24 && minute == 0 && second == 0 && micro == 0;
  if ((hour > 23 && !midnight) || minute > 59 || second > 59) return std::nullopt;
  return (*day * kDay_s + hour * 3600 + minute * 60 + second - offset_s) * kMicro + micro;
}

std::optional<std::int64_t> parseDate(std::string_view lexical) {
  Reader reader(lexical);
  const std::optional<std::int64_t> day = readDay(reader);
  std::int64_t offset_s = 0;
  if (!day || !reader.atZone() || !reader.zone(offset_s)) return std::nullopt;
  return (*day * kDay_s - offset_s) * kMicro;
}

}  // namespace cluxel
