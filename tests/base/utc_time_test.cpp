// SPDX-License-Identifier: Apache-2.0
// Times as texts: to the microsecond, within the years that texts have.
#include "base/utc_time.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>

namespace cluxel {
namespace {

TEST(UtcTime, IsWrittenWithMicroseconds) {
  EXPECT_EQ(dateTimeText(0), "1970-01-01T00:00:00.000000Z");
  EXPECT_EQ(dateTimeText(-0.25), "1969-12-31T23:59:59.750000Z");
  EXPECT_EQ(dateTimeText(1700086400.1234567), "2023-11-15T22:13:20.123457Z");
  EXPECT_EQ(dateTimeText(-62135596800), "0001-01-01T00:00:00.000000Z");
  EXPECT_EQ(dateTimeText(253402300799), "9999-12-31T23:59:59.000000Z");
}

TEST(UtcTime, OutsideOfTheCalendarIsWrittenAsANumber) {
  EXPECT_EQ(dateTimeText(1e300), "1.0000000000000001e+300 s since 1970");
  EXPECT_EQ(dateTimeText(-1e18), "-1e+18 s since 1970");
  EXPECT_EQ(dateTimeText(253402300800), "253402300800 s since 1970");
  EXPECT_EQ(dateTimeText(std::numeric_limits<double>::infinity()), "inf s since 1970");
  EXPECT_FALSE(hasCalendarYear(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_EQ(toMicroseconds(1e300), 1e300);
}

TEST(UtcTime, ToMicrosecondsIsTheNumberThatItsDigitsMean) {
  std::mt19937_64 random(1);
  for (const double span_s : {10.0, 1.7e9, 4e9, 8e9}) {
    std::uniform_real_distribution<double> any(-span_s, span_s);
    for (int i = 0; i < 20'000; ++i) {
      const double time_s = any(random), rounded = toMicroseconds(time_s);
      char digits[64];
      std::snprintf(digits, sizeof digits, "%.6f", rounded);
      ASSERT_EQ(rounded, std::strtod(digits, nullptr)) << digits;
      ASSERT_NEAR(rounded, time_s, 1e-6) << digits;
      ASSERT_EQ(toMicroseconds(rounded), rounded) << digits;
      ASSERT_EQ(dateTimeText(time_s), dateTimeText(rounded)) << digits;
    }
  }
  EXPECT_EQ(toMicroseconds(2e11 + 1.0 / 32768), 2e11 + 1.0 / 32768);  // numbers there are 30 microseconds apart
}

}  // namespace
}  // namespace cluxel
