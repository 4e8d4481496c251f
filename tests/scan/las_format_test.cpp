// SPDX-License-Identifier: Apache-2.0
// Tests on LAS files that are generated here.
#include "scan/formats/las_format.hpp"

#include <array>
#include <limits>

#include "scan/scan_fixture.hpp"

namespace cluxel::scan {
namespace {

using test::refusalOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::array<std::uint16_t, 11> kRecordBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

template <typename T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

struct LasPoint {
  std::int32_t x, y, z;
  std::uint16_t intensity;
  std::uint8_t classification;
};

std::string lasFile(unsigned minor, unsigned format, const std::vector<LasPoint>& points) {
  const std::size_t header = minor == 4 ? 375 : 227;
  std::string bytes(header, '\0');
  bytes.replace(0, 4, "LASF");
  put<std::uint8_t>(bytes, 24, 1);
  put<std::uint8_t>(bytes, 25, static_cast<std::uint8_t>(minor));
  put<std::uint16_t>(bytes, 94, static_cast<std::uint16_t>(header));
  put<std::uint32_t>(bytes, 96, static_cast<std::uint32_t>(header));
  put<std::uint8_t>(bytes, 104, static_cast<std::uint8_t>(format));
  put<std::uint16_t>(bytes, 105, kRecordBytes[format]);
  const bool wide = minor == 4 && format >= 6;
  put<std::uint32_t>(bytes, 107, wide ? 0 : static_cast<std::uint32_t>(points.size()));
  if (minor == 4) put<std::uint64_t>(bytes, 247, points.size());
  for (const int axis : {0, 1, 2}) put(bytes, 131 + 8 * static_cast<std::size_t>(axis), 0.001);
  put(bytes, 155, 100.0);
  for (const LasPoint& p : points) {
    std::string record(kRecordBytes[format], '\0');
    put(record, 0, p.x);
    put(record, 4, p.y);
    put(record, 8, p.z);
    put(record, 12, p.intensity);
    put(record, format >= 6 ? 16 : 15, p.classification);
    bytes += record;
  }
  return bytes;
}

const std::vector<LasPoint> kPoints{{1000, 2000, 3000, 7, 2}, {-1000, 0, 500, 9, 5}};

TEST(LasFormat, ReadsEveryPointFormatOfEveryVersion) {
  for (unsigned minor = 2; minor <= 4; ++minor)
    for (unsigned format = 0; format < kRecordBytes.size(); ++format) {
      const ParsedScan scan = parseLas(lasFile(minor, format, kPoints), "a.las");
      ASSERT_THAT(scan.points.x, ElementsAre(101.F, 99.F)) << minor << ' ' << format;
      EXPECT_THAT(scan.points.z, ElementsAre(3.F, 0.5F));
      EXPECT_THAT(scan.points.intensity, ElementsAre(7.F, 9.F));
      EXPECT_THAT(scan.points.label, ElementsAre(2U, 5U));
    }
}

TEST(LasFormat, SkipsWithheldPoints) {
  for (const unsigned format : {0U, 3U, 6U, 10U}) {
    std::string bytes = lasFile(4, format, {kPoints[0], kPoints[1], {2000, 0, 0, 1, 6}});
    const std::size_t second = 375 + kRecordBytes[format];
    const std::uint8_t flags = format >= 6 ? 0x04 : 0x80 | 5;
    put(bytes, second + 15, flags);
    const ParsedScan scan = parseLas(bytes, "a.las");
    EXPECT_THAT(scan.points.x, ElementsAre(101.F, 102.F)) << format;
    EXPECT_THAT(scan.points.label, ElementsAre(2U, 6U));
    EXPECT_THAT(scan.no_return, ElementsAre(1U));
    EXPECT_EQ(scan.withheld_count, 1U);
  }
}

TEST(LasFormat, KeepsSyntheticPointsKeyPointsAndOverlaps) {
  for (const auto& [format, flags] : {std::pair(0U, 0x60U | 2U), std::pair(6U, 0x0BU)}) {
    std::string bytes = lasFile(4, format, {kPoints[0]});
    put(bytes, 375 + 15, static_cast<std::uint8_t>(flags));
    EXPECT_EQ(parseLas(bytes, "a.las").points.size(), 1U) << format;
  }
}

TEST(LasFormat, RefusesAFileOfWithheldPointsAlone) {
  std::string bytes = lasFile(2, 0, {kPoints[0]});
  put<std::uint8_t>(bytes, 227 + 15, 0x82);
  EXPECT_THAT(refusalOf([&] { parseLas(bytes, "a.las"); }), HasSubstr("marks all of its 1 points as withheld"));
}

TEST(LasFormat, LeavesOutIntensityAndLabelsThatWereNotRecorded) {
  const ParsedScan scan = parseLas(lasFile(2, 0, {{1, 2, 3, 0, 0}}), "a.las");
  EXPECT_TRUE(scan.points.intensity.empty());
  EXPECT_TRUE(scan.points.label.empty());
}

TEST(LasFormat, KeepsMillimetresOfWorldCoordinates) {
  std::string bytes = lasFile(2, 0, kPoints);
  put(bytes, 155, 456000.0);
  const ParsedScan scan = parseLas(bytes, "a.las");
  EXPECT_EQ(scan.local_origin, Eigen::Vector3d(456000, 0, 0));
  EXPECT_THAT(scan.points.x, ElementsAre(1.F, -1.F));
}

TEST(LasFormat, RefusesLazInPlainWords) {
  std::string bytes = lasFile(2, 1, kPoints);
  put<std::uint8_t>(bytes, 104, 128 + 1);
  EXPECT_THAT(refusalOf([&] { parseLas(bytes, "a.laz"); }),
              HasSubstr("a.laz: byte 104: error: the points are compressed (LAZ)"));
}

TEST(LasFormat, RefusesATruncatedFileNamingTheByte) {
  const std::string bytes = lasFile(2, 0, kPoints);
  const std::string cut = bytes.substr(0, bytes.size() - 1);
  EXPECT_THAT(refusalOf([&] { parseLas(cut, "a.las"); }),
              HasSubstr("byte 266: error: the file ends after 1 of 2 points"));
  EXPECT_THAT(refusalOf([&] { parseLas(bytes.substr(0, 100), "a.las"); }),
              HasSubstr("byte 100: error: the LAS header is cut off"));
}

TEST(LasFormat, RefusesMorePointsThanTheHeaderTells) {
  for (const unsigned minor : {2U, 4U}) {
    const std::string whole = lasFile(minor, 0, kPoints);
    std::string fewer = whole;
    put<std::uint32_t>(fewer, 107, 1);
    if (minor == 4) put<std::uint64_t>(fewer, 247, 1);
    EXPECT_THAT(refusalOf([&] { parseLas(fewer, "a.las"); }),
                HasSubstr("behind the 1 points of the header lies room for 1 more"));
    EXPECT_NO_THROW(parseLas(whole + "padding", "a.las"));
  }
  std::string records = lasFile(4, 0, kPoints);
  const std::uint64_t end = records.size();
  records += std::string(100, 'r');
  EXPECT_THROW(parseLas(records, "a.las"), InputError);
  put(records, 235, end);
  EXPECT_NO_THROW(parseLas(records, "a.las")) << "extended records";
}

TEST(LasFormat, RefusesEveryPrefixOfAFile) {
  const std::string bytes = lasFile(4, 6, kPoints);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_THROW(parseLas(std::string_view(bytes).substr(0, length), "a.las"), InputError) << length;
}

TEST(LasFormat, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT(refusalOf([] { parseLas("PLY and so on", "a.las"); }), HasSubstr("does not begin with 'LASF'"));
  std::string version = lasFile(2, 0, kPoints);
  put<std::uint8_t>(version, 25, 5);
  EXPECT_THAT(refusalOf([&] { parseLas(version, "a.las"); }), HasSubstr("LAS 1.5 is not supported"));
  std::string format = lasFile(2, 0, kPoints);
  put<std::uint8_t>(format, 104, 11);
  EXPECT_THAT(refusalOf([&] { parseLas(format, "a.las"); }), HasSubstr("unknown point format 11"));
  std::string record = lasFile(2, 0, kPoints);
  put<std::uint16_t>(record, 105, 19);
  EXPECT_THAT(refusalOf([&] { parseLas(record, "a.las"); }), HasSubstr("too short for format 0"));
  EXPECT_THAT(refusalOf([&] { parseLas(lasFile(2, 0, {}), "a.las"); }), HasSubstr("holds no points"));
}

TEST(LasFormat, RefusesNumbersThatAreNotFinite) {
  std::string scale = lasFile(2, 0, kPoints);
  put(scale, 131, 0.0);
  EXPECT_THAT(refusalOf([&] { parseLas(scale, "a.las"); }), HasSubstr("byte 131: error: the scale factors"));
  std::string offset = lasFile(2, 0, kPoints);
  put(offset, 163, std::numeric_limits<double>::infinity());
  EXPECT_THAT(refusalOf([&] { parseLas(offset, "a.las"); }), HasSubstr("byte 155: error: the offsets are not finite"));
  std::string huge = lasFile(2, 0, kPoints);
  put(huge, 139, 1e300);
  EXPECT_THAT(refusalOf([&] { parseLas(huge, "a.las"); }), HasSubstr("point 0 has a coordinate beyond 10000 km"));
}

}  // namespace
}  // namespace cluxel::scan
