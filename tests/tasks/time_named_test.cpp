// SPDX-License-Identifier: Apache-2.0
// Times that a person writes: dates, or seconds since 1970.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "tasks/changes/site_changes.hpp"

namespace cluxel::tasks {
namespace {

TEST(TimeNamed, ReadsDatesAndSeconds) {
  EXPECT_DOUBLE_EQ(timeNamed("2023-11-14T22:13:20Z"), 1.7e9);
  EXPECT_DOUBLE_EQ(timeNamed("1700000000.5"), 1700000000.5);
  EXPECT_DOUBLE_EQ(timeNamed("1970-01-02"), 86400);
  for (const char* text : {"yesterday", "nan", "inf"}) EXPECT_THROW(timeNamed(text), Error) << text;
}

TEST(TimeNamed, RefusesTimesThatNoScanCanHave) {
  for (const char* text :
       {"1e300", "-1e300", "1e18", "253402300800", "99999-01-01T00:00:00Z", "-0001-01-01T00:00:00Z", "0000-01-01"}) {
    try {
      timeNamed(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr(std::string("'") + text + "' ")) << text;
    }
  }
  EXPECT_EQ(timeNamed("0001-01-01T00:00:00Z"), -62135596800);
  EXPECT_EQ(timeNamed("9999-12-31T23:59:59Z"), 253402300799);
}

TEST(TimeNamed, ReadsBackTheTimesThatAreWritten) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-6e10, 2.5e11), recent(0, 4e9);
  for (int i = 0; i < 5000; ++i)
    for (const double time_s : {toMicroseconds(any(random)), toMicroseconds(recent(random))})
      ASSERT_EQ(timeNamed(dateTimeText(time_s)), time_s) << dateTimeText(time_s);
  EXPECT_EQ(timeNamed("1700086400.1234567"), 1700086400.123457);
}

}  // namespace
}  // namespace cluxel::tasks
