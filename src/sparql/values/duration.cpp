// SPDX-License-Identifier: Apache-2.0
// xsd:duration, dayTimeDuration and yearMonthDuration: lexical forms and comparison.
#include <array>
#include <string>

#include "sparql/values/calendar.hpp"

namespace cluxel::sparql {
namespace {

struct Field {
  char letter;
  bool time;            ///< belongs to the part after T
  std::int64_t months;  ///< per unit
  std::int64_t seconds;
};

constexpr std::array<Field, 6> kFields = {{{'Y', false, 12, 0},
                                           {'M', false, 1, 0},
                                           {'D', false, 0, 86400},
                                           {'H', true, 0, 3600},
                                           {'M', true, 0, 60},
                                           {'S', true, 0, 1}}};

bool allowed(DurationKind kind, const Field& field) {
  return kind == DurationKind::Duration || (kind == DurationKind::YearMonth) == (field.months != 0);
}

/// Reads a number and its unit letter; false for other text.
bool readNumber(std::string_view& text, std::string_view& number, char& letter) {
  const std::size_t end = text.find_first_not_of("0123456789.");
  if (end == std::string_view::npos || end == 0 || end > 18) return false;
  number = text.substr(0, end);
  letter = text[end];
  text.remove_prefix(end + 1);
  return true;
}

bool addField(const Field& field, std::string_view number, Duration& out) {
  const bool fraction = number.find('.') != std::string_view::npos;
  if (fraction && (field.letter != 'S' || number.front() == '.' || number.back() == '.')) return false;
  const auto value = Decimal::parse(number);
  if (!value) return false;
  if (field.months != 0) {
    const auto whole = value->toInt64();
    if (!whole || *whole > 1'000'000'000'000) return false;
    out.months += *whole * field.months;
    return true;
  }
  out.seconds = *Decimal::add(out.seconds, *Decimal::multiply(*value, Decimal(field.seconds)));
  return true;
}

}  // namespace

std::optional<Duration> parseDuration(DurationKind kind, std::string_view text) {
  const bool negative = !text.empty() && text.front() == '-';
  if (negative) text.remove_prefix(1);
  if (text.empty() || text.front() != 'P') return std::nullopt;
  text.remove_prefix(1);
  Duration out;
  bool time = false, any = false;
  std::size_t next_field = 0;
  while (!text.empty()) {
    if (text.front() == 'T' && !time) {
      time = true;
      any = false;  // T must be followed by a field
      text.remove_prefix(1);
      continue;
    }
    std::string_view number;
    char letter = 0;
    if (!readNumber(text, number, letter)) return std::nullopt;
    while (next_field < kFields.size() && (kFields[next_field].letter != letter || kFields[next_field].time != time)) {
      ++next_field;
    }
    if (next_field == kFields.size() || !allowed(kind, kFields[next_field])) return std::nullopt;
    if (!addField(kFields[next_field++], number, out)) return std::nullopt;
    any = true;
  }
  if (!any) return std::nullopt;
  if (negative) out = {-out.months, -out.seconds};
  return out;
}

std::string formatDuration(DurationKind kind, const Duration& value) {
  const bool negative = value.months < 0 || value.seconds.isNegative();
  const std::int64_t months = negative ? -value.months : value.months;
  const Decimal seconds = negative ? -value.seconds : value.seconds;
  std::string out = negative ? "-P" : "P";
  if (months / 12 != 0) out += std::to_string(months / 12) + "Y";
  if (months % 12 != 0) out += std::to_string(months % 12) + "M";
  const Decimal::Integer whole = seconds.truncated();
  const Decimal::Integer days = whole / 86400;
  const auto rest = static_cast<std::int64_t>(whole % 86400);
  const Decimal fraction = *Decimal::subtract(seconds, Decimal(whole));
  if (days != 0) out += days.str() + "D";
  std::string clock;
  if (rest / 3600 != 0) clock += std::to_string(rest / 3600) + "H";
  if (rest / 60 % 60 != 0) clock += std::to_string(rest / 60 % 60) + "M";
  const Decimal second = *Decimal::add(Decimal(rest % 60), fraction);
  if (!second.isZero()) clock += second.text() + "S";
  if (!clock.empty()) out += "T" + clock;
  if (out == "P") return kind == DurationKind::YearMonth ? "P0M" : "PT0S";
  return out;
}

std::partial_ordering compareDuration(const Duration& a, const Duration& b) {
  if (a == b) return std::partial_ordering::equivalent;
  // The four starting points of XML Schema 1.1 (3.3.6.2), which cover all month lengths.
  constexpr std::array<std::pair<std::int64_t, int>, 4> kStarts = {{{1696, 9}, {1697, 2}, {1903, 3}, {1903, 7}}};
  std::optional<std::strong_ordering> common;
  for (const auto& [year, month] : kStarts) {
    CalendarTime start{year, month, 1, 0, 0, Decimal(), 0};
    const auto left = addDuration(start, a, false), right = addDuration(start, b, false);
    if (!left || !right) return std::partial_ordering::unordered;
    const auto order = left->timeline() <=> right->timeline();
    if (common && *common != order) return std::partial_ordering::unordered;
    common = order;
  }
  return *common;
}

}  // namespace cluxel::sparql
