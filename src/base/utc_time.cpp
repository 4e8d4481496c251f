// SPDX-License-Identifier: Apache-2.0
// Calendar arithmetic by <chrono>; no time zone data is needed.
#include "base/utc_time.hpp"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace cluxel {

double secondsNow() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::string dateTimeText(double time_s) {
  using namespace std::chrono;
  const auto total_us = static_cast<std::int64_t>(std::llround(time_s * 1e6));
  const sys_time<microseconds> time{microseconds(total_us)};
  const sys_days day = floor<days>(time);
  const year_month_day date(day);
  const hh_mm_ss<microseconds> clock(time - day);
  char text[64];
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02d:%02d:%02d.%06dZ", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()), static_cast<int>(clock.subseconds().count()));
  return text;
}

}  // namespace cluxel
