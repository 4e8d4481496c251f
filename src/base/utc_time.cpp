// SPDX-License-Identifier: Apache-2.0
// Calendar arithmetic by <chrono>; no time zone data is needed.
#include "base/utc_time.hpp"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace cluxel {

double secondsNow() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

namespace {

// The first moment of year 1 and of year 10000.
constexpr double kFirst_s = -62135596800.0, kEnd_s = 253402300800.0;

/// For times of the years 1 to 9999. The product is not rounded: half a microsecond decides.
std::int64_t microsecondsOf(double time_s) {
  return std::llround(static_cast<long double>(time_s) * 1'000'000);
}

}  // namespace

bool hasCalendarYear(double time_s) {
  return time_s >= kFirst_s && time_s < kEnd_s;
}

double toMicroseconds(double time_s) {
  constexpr std::int64_t kExact = std::int64_t{1} << 53;  // above, neighbouring numbers are microseconds apart
  if (!hasCalendarYear(time_s)) return time_s;
  const std::int64_t rounded = microsecondsOf(time_s);
  return std::abs(rounded) <= kExact ? static_cast<double>(rounded) / 1e6 : time_s;
}

std::optional<double> toMicroseconds(std::optional<double> time_s) {
  return time_s ? std::optional(toMicroseconds(*time_s)) : std::nullopt;
}

std::string dateTimeText(double time_s) {
  using namespace std::chrono;
  char text[64];
  if (!hasCalendarYear(time_s)) {
    std::snprintf(text, sizeof text, "%.17g s since 1970", time_s);
    return text;
  }
  const sys_time<microseconds> time{microseconds(microsecondsOf(time_s))};
  const sys_days day = floor<days>(time);
  const year_month_day date(day);
  const hh_mm_ss<microseconds> clock(time - day);
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02d:%02d:%02d.%06dZ", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()), static_cast<int>(clock.subseconds().count()));
  return text;
}

}  // namespace cluxel
