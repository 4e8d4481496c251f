// SPDX-License-Identifier: Apache-2.0
// Tests of KITTI's binary records and labels.
#include "scan/formats/kitti_format.hpp"

#include <limits>

#include "scan/scan_fixture.hpp"

namespace cluxel::scan {
namespace {

using test::bytesOfAll;
using test::refusalOf;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(KittiFormat, ReadsRecordsOfFourFloats) {
  const ParsedScan scan = parseKittiPoints(bytesOfAll(1.F, 2.F, 3.F, 0.5F, 4.F, 5.F, 6.F, 0.25F), "a.bin");
  EXPECT_THAT(scan.points.y, ElementsAre(2.F, 5.F));
  EXPECT_THAT(scan.points.intensity, ElementsAre(0.5F, 0.25F));
}

TEST(KittiFormat, RefusesACutOffPointNamingTheByte) {
  const std::string bytes = bytesOfAll(1.F, 2.F, 3.F, 0.5F, 4.F);
  EXPECT_THAT(refusalOf([&] { parseKittiPoints(bytes, "a.bin"); }),
              HasSubstr("a.bin: byte 16: error: the last point is cut off: 4 bytes"));
}

TEST(KittiFormat, RefusesAnEmptyFile) {
  EXPECT_THAT(refusalOf([] { parseKittiPoints("", "a.bin"); }), HasSubstr("holds no points"));
}

TEST(KittiFormat, SkipsAndCountsPointsWithoutAReturn) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const ParsedScan scan =
      parseKittiPoints(bytesOfAll(inf, 2.F, 3.F, 0.F, 1.F, 2.F, 3.F, 0.5F, 1.F, nan, 3.F, nan), "a.bin");
  EXPECT_THAT(scan.points.x, ElementsAre(1.F));
  EXPECT_THAT(scan.points.intensity, ElementsAre(0.5F));
  EXPECT_THAT(scan.no_return, ElementsAre(0U, 2U));
  EXPECT_THAT(refusalOf([&] { parseKittiPoints(bytesOfAll(nan, nan, nan, 0.F), "a.bin"); }),
              HasSubstr("a.bin: error: none of its 1 points has a finite position"));
}

TEST(KittiFormat, RefusesUnusableNumbersNamingTheByte) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::string late = bytesOfAll(1.F, 2.F, 3.F, 0.F, 1.F, 1e11F, 3.F, 0.F);
  EXPECT_THAT(refusalOf([&] { parseKittiPoints(late, "a.bin"); }),
              HasSubstr("byte 16: error: point 1 has a coordinate beyond 10000 km"));
  const std::string dark = bytesOfAll(1.F, 2.F, 3.F, nan);
  EXPECT_THAT(refusalOf([&] { parseKittiPoints(dark, "a.bin"); }),
              HasSubstr("byte 12: error: point 0 has an intensity"));
}

TEST(KittiFormat, TakesTheClassFromTheLowHalfOfALabel) {
  EXPECT_THAT(parseKittiLabels(bytesOfAll(std::uint32_t{0x00070051}, std::uint32_t{40}), "a.label", 2),
              ElementsAre(81U, 40U));
}

TEST(KittiFormat, RefusesLabelsOfAnotherNumberOfPoints) {
  const std::string labels = bytesOfAll(1U, 2U, 3U);
  EXPECT_THAT(refusalOf([&] { parseKittiLabels(labels, "a.label", 2); }),
              HasSubstr("a.label: byte 8: error: the file has 12 bytes where 8"));
  EXPECT_THAT(refusalOf([&] { parseKittiLabels(labels, "a.label", 4); }),
              HasSubstr("a.label: byte 12: error: the file has 12 bytes where 16"));
}

}  // namespace
}  // namespace cluxel::scan
