// SPDX-License-Identifier: Apache-2.0
// The line that shows the progress of long work.
#include "app/console/progress_line.hpp"

#include <gtest/gtest.h>

namespace cluxel::app {
namespace {

TEST(ProgressLine, HasNoRateBeforeASecondHasPassed) {
  ProgressMeter meter;
  EXPECT_EQ(meter.line("reading", 0, 10, 5.0), "reading 0/10  0 %");
  EXPECT_EQ(meter.line("reading", 3, 10, 5.9), "reading 3/10  30 %");
}

TEST(ProgressLine, ShowsRateAndTimeLeft) {
  ProgressMeter meter;
  meter.line("reading", 0, 120, 100);
  EXPECT_EQ(meter.line("reading", 30, 120, 112), "reading 30/120  25 %  2.5/s  36 s left");
  EXPECT_EQ(meter.line("reading", 120, 120, 112), "reading 120/120  100 %  10/s");
}

TEST(ProgressLine, MeasuresFromTheFirstReportOfAStage) {
  ProgressMeter meter;
  meter.line("reading", 0, 10, 0);
  meter.line("tiles", 50, 100, 1000);
  EXPECT_EQ(meter.line("tiles", 60, 100, 1010), "tiles 60/100  60 %  1.0/s  40 s left");
}

TEST(ProgressLine, StartsAnewWhenAStageRunsAgain) {
  ProgressMeter meter;
  meter.line("tiles", 0, 10, 0);
  meter.line("tiles", 10, 10, 100);
  EXPECT_EQ(meter.line("tiles", 1, 10, 200), "tiles 1/10  10 %");
  EXPECT_EQ(meter.line("tiles", 2, 10, 210), "tiles 2/10  20 %  0.1/s  1 min 20 s left");
}

TEST(ProgressLine, TakesAnUnknownTotal) {
  ProgressMeter meter;
  EXPECT_EQ(meter.line("reading", 0, 0, 0), "reading 0/0");
  EXPECT_EQ(meter.line("reading", 7, 0, 7), "reading 7/0  1.0/s");
}

TEST(ProgressLine, WritesDurationsForPeople) {
  EXPECT_EQ(durationText(-1), "0 s");
  EXPECT_EQ(durationText(59.4), "59 s");
  EXPECT_EQ(durationText(59.6), "1 min 00 s");
  EXPECT_EQ(durationText(185), "3 min 05 s");
  EXPECT_EQ(durationText(7620), "2 h 07 min");
}

}  // namespace
}  // namespace cluxel::app
