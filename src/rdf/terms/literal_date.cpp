// SPDX-License-Identifier: Apache-2.0
// The lexical forms of XML Schema 1.1 part 2, section 3.3, read without allocation.
#include "rdf/terms/literal_date.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "base/ascii.hpp"

namespace cluxel::rdf {

namespace {

/// Consumes fields from the front of a text; each function returns whether the field was valid.
class FieldReader {
 public:
  explicit FieldReader(std::string_view text) : rest_(text) {}

  bool done() const { return rest_.empty(); }
  bool is(char c) const { return !rest_.empty() && rest_.front() == c; }
  bool take(char c) {
    if (!is(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  std::string_view digits() {
    const auto end = std::find_if_not(rest_.begin(), rest_.end(), isAsciiDigit);
    const std::string_view result(rest_.data(), static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(result.size());
    return result;
  }
  /// Exactly two digits within [low, high].
  bool twoDigits(int& value, int low, int high) {
    if (rest_.size() < 2 || !isAsciiDigit(rest_[0]) || !isAsciiDigit(rest_[1])) return false;
    value = (rest_[0] - '0') * 10 + (rest_[1] - '0');
    rest_.remove_prefix(2);
    return low <= value && value <= high;
  }
  bool year(std::int64_t& value) {
    const bool negative = take('-');
    const std::string_view found = digits();
    if (found.size() < 4 || found.size() > 11 || (found.size() > 4 && found.front() == '0')) return false;
    value = 0;
    for (const char c : found) value = value * 10 + (c - '0');
    if (negative) value = -value;
    return true;
  }
  bool yearMonth(CivilDate& date) { return year(date.year) && take('-') && twoDigits(date.month, 1, 12); }
  bool day(CivilDate& date, std::int64_t year) {
    return take('-') && twoDigits(date.day, 1, daysInMonth(year, date.month));
  }
  bool clock(CalendarFields& fields) {
    if (!twoDigits(fields.hour, 0, 24) || !take(':') || !twoDigits(fields.minute, 0, 59) || !take(':') ||
        !twoDigits(fields.second, 0, 59))
      return false;
    if (take('.') && (fields.fraction = digits()).empty()) return false;
    const bool full_hour =
        fields.minute == 0 && fields.second == 0 && fields.fraction.find_first_not_of('0') == std::string_view::npos;
    return fields.hour < 24 || full_hour;
  }
  bool zone(std::optional<int>& minutes_east) {
    if (take('Z')) {
      minutes_east = 0;
      return true;
    }
    if (!is('+') && !is('-')) return true;
    const int sign = take('-') ? -1 : (take('+'), 1);
    int hours = 0, minutes = 0;
    if (!twoDigits(hours, 0, 14) || !take(':') || !twoDigits(minutes, 0, 59)) return false;
    minutes_east = sign * (hours * 60 + minutes);
    return hours < 14 || minutes == 0;
  }

 private:
  std::string_view rest_;
};

bool readFields(CalendarKind kind, FieldReader& in, CalendarFields& fields) {
  CivilDate& date = fields.date;
  switch (kind) {
    case CalendarKind::DateTime:
      return in.yearMonth(date) && in.day(date, date.year) && in.take('T') && in.clock(fields);
    case CalendarKind::Date:
      return in.yearMonth(date) && in.day(date, date.year);
    case CalendarKind::Time:
      return in.clock(fields);
    case CalendarKind::YearMonth:
      date.day = 1;
      return in.yearMonth(date);
    case CalendarKind::Year:
      date.month = date.day = 1;
      return in.year(date.year);
    case CalendarKind::MonthDay:
      return in.take('-') && in.take('-') && in.twoDigits(date.month, 1, 12) && in.day(date, 1972);
    case CalendarKind::Day:
      return in.take('-') && in.take('-') && in.take('-') && in.twoDigits(date.day, 1, 31);
    case CalendarKind::Month:
      date.day = 1;
      return in.take('-') && in.take('-') && in.twoDigits(date.month, 1, 12);
  }
  return false;
}

std::int64_t microsecondsOf(std::string_view fraction) {
  std::int64_t sum = 0, unit = 100'000;
  for (const char c : fraction.substr(0, 6)) {
    sum += (c - '0') * unit;
    unit /= 10;
  }
  return sum;
}

}  // namespace

/// The era arithmetic of Howard Hinnant: years start in March, and the calendar repeats every 400 years.
std::int64_t daysFromCivil(const CivilDate& date) {
  const std::int64_t year = date.year - (date.month <= 2 ? 1 : 0);
  const std::int64_t era = (year >= 0 ? year : year - 399) / 400;
  const std::int64_t year_of_era = year - era * 400;
  const std::int64_t day_of_year = (153 * (date.month + (date.month > 2 ? -3 : 9)) + 2) / 5 + date.day - 1;
  const std::int64_t day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
  return era * 146'097 + day_of_era - 719'468;
}

CivilDate civilFromDays(std::int64_t days) {
  days += 719'468;
  const std::int64_t era = (days >= 0 ? days : days - 146'096) / 146'097;
  const std::int64_t day_of_era = days - era * 146'097;
  const std::int64_t year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36'524 - day_of_era / 146'096) / 365;
  const std::int64_t day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
  const std::int64_t shifted_month = (5 * day_of_year + 2) / 153;
  CivilDate date;
  date.day = static_cast<int>(day_of_year - (153 * shifted_month + 2) / 5 + 1);
  date.month = static_cast<int>(shifted_month < 10 ? shifted_month + 3 : shifted_month - 9);
  date.year = year_of_era + era * 400 + (date.month <= 2 ? 1 : 0);
  return date;
}

int daysInMonth(std::int64_t year, int month) {
  constexpr std::array<int, 12> kDays = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  return kDays[static_cast<std::size_t>(month - 1)] + (month == 2 && leap ? 1 : 0);
}

std::optional<CalendarFields> parseCalendarFields(CalendarKind kind, std::string_view lexical) {
  FieldReader in(lexical);
  CalendarFields fields;
  if (!readFields(kind, in, fields) || !in.zone(fields.zone_minutes) || !in.done()) return std::nullopt;
  if (fields.hour == 24) {
    fields.hour = 0;
    if (kind == CalendarKind::DateTime) fields.date = civilFromDays(daysFromCivil(fields.date) + 1);
  }
  return fields;
}

std::optional<std::int64_t> parseMicroseconds(CalendarKind kind, std::string_view lexical) {
  constexpr std::int64_t kMaxYear = 290'000;
  const std::optional<CalendarFields> fields = parseCalendarFields(kind, lexical);
  if (!fields || !fields->zone_minutes || std::abs(fields->date.year) > kMaxYear) return std::nullopt;
  const std::int64_t minutes =
      daysFromCivil(fields->date) * 1440 + fields->hour * 60 + fields->minute - *fields->zone_minutes;
  return (minutes * 60 + fields->second) * 1'000'000 + microsecondsOf(fields->fraction);
}

}  // namespace cluxel::rdf
