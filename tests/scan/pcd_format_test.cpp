// SPDX-License-Identifier: Apache-2.0
// Tests of valid and faulty PCD headers and bodies.
#include "scan/formats/pcd_format.hpp"

#include <limits>

#include "scan/scan_fixture.hpp"

namespace cluxel::scan {
namespace {

using test::bytesOfAll;
using test::refusalOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string header(const std::string& fields, const std::string& size, const std::string& type, int points,
                   const std::string& data, const std::string& viewpoint = "0 0 0 1 0 0 0") {
  const std::string n = std::to_string(points);
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + size + "\nTYPE " +
         type + "\nWIDTH " + n + "\nHEIGHT 1\nVIEWPOINT " + viewpoint + "\nPOINTS " + n + "\nDATA " + data + "\n";
}

/// Literal runs only, which every LZF decoder accepts.
std::string storedAsLzf(const std::string& bytes) {
  std::string packed;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::string run = bytes.substr(at, 32);
    packed += static_cast<char>(run.size() - 1) + run;
  }
  return packed;
}

TEST(PcdFormat, ReadsTextBinaryAndCompressedAlike) {
  const std::string text =
      header("x y z intensity label", "4 4 4 4 4", "F F F F U", 2, "ascii") + "1 2 3 0.5 7\n4 5 6 0.25 8\n";
  const std::string packed = bytesOfAll(1.F, 2.F, 3.F, 0.5F, 7U, 4.F, 5.F, 6.F, 0.25F, 8U);
  const std::string binary = header("x y z intensity label", "4 4 4 4 4", "F F F F U", 2, "binary") + packed;
  const std::string columns = bytesOfAll(1.F, 4.F, 2.F, 5.F, 3.F, 6.F, 0.5F, 0.25F, 7U, 8U);
  const std::string lzf = storedAsLzf(columns);
  const std::string compressed = header("x y z intensity label", "4 4 4 4 4", "F F F F U", 2, "binary_compressed") +
                                 bytesOfAll(static_cast<std::uint32_t>(lzf.size()), 40U) + lzf;
  for (const std::string& bytes : {text, binary, compressed}) {
    const ParsedScan scan = parsePcd(bytes, "a.pcd");
    EXPECT_THAT(scan.points.x, ElementsAre(1.F, 4.F));
    EXPECT_THAT(scan.points.z, ElementsAre(3.F, 6.F));
    EXPECT_THAT(scan.points.intensity, ElementsAre(0.5F, 0.25F));
    EXPECT_THAT(scan.points.label, ElementsAre(7U, 8U));
    EXPECT_FALSE(scan.viewpoint.has_value());
  }
}

TEST(PcdFormat, TakesFieldsOfAnyTypeOrderAndConvention) {
  const std::string bytes =
      header("rgb Reflectivity classification _ z y x", "4 1 2 1 8 8 8", "U U I U F F F", 1, "binary") +
      bytesOfAll(1U, std::uint8_t{200}, std::int16_t{6}, std::uint8_t{0}, 3.0, 2.0, 1.0);
  const ParsedScan scan = parsePcd(bytes, "a.pcd");
  EXPECT_THAT(scan.points.x, ElementsAre(1.F));
  EXPECT_THAT(scan.points.intensity, ElementsAre(200.F));
  EXPECT_THAT(scan.points.label, ElementsAre(6U));
}

TEST(PcdFormat, SkipsFieldsOfSeveralNumbers) {
  const std::string head =
      "VERSION .7\nFIELDS histogram x y z\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 3 1 1 1\nWIDTH 1\nHEIGHT "
      "1\nPOINTS 1\nDATA ";
  EXPECT_THAT(parsePcd(head + "ascii\n9 nan 9 1 2 3\n", "a").points.z, ElementsAre(3.F));
  EXPECT_THAT(parsePcd(head + "binary\n" + bytesOfAll(9.F, 9.F, 9.F, 1.F, 2.F, 3.F), "a").points.z, ElementsAre(3.F));
}

TEST(PcdFormat, TakesMinusOneAsALabelForNone) {
  const std::string bytes = header("x y z label", "4 4 4 4", "F F F F", 1, "ascii") + "1 2 3 -1\n";
  EXPECT_THAT(parsePcd(bytes, "a.pcd").points.label, ElementsAre(0xFFFFFFFFU));
}

TEST(PcdFormat, GivesTheViewpointWhenItIsNotTheIdentity) {
  const std::string bytes = header("x y z", "4 4 4", "F F F", 1, "ascii", "1 2 3 0 0 0 1") + "1 0 0\n";
  const auto viewpoint = pcdViewpoint(bytes, "a.pcd");
  ASSERT_TRUE(viewpoint.has_value());
  EXPECT_TRUE((*viewpoint * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0, 2, 3)));
}

TEST(PcdFormat, RefusesEveryPrefixOfABinaryFile) {
  const std::string bytes = header("x y z", "4 4 4", "F F F", 2, "binary") + bytesOfAll(1.F, 2.F, 3.F, 4.F, 5.F, 6.F);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_THROW(parsePcd(std::string_view(bytes).substr(0, length), "a.pcd"), InputError) << length;
}

TEST(PcdFormat, RefusesATruncatedBodyNamingTheByte) {
  const std::string bytes = header("x y z", "4 4 4", "F F F", 2, "binary") + bytesOfAll(1.F, 2.F, 3.F, 4.F);
  EXPECT_THAT(refusalOf([&] { parsePcd(bytes, "a.pcd"); }),
              HasSubstr("a.pcd: byte " + std::to_string(bytes.size()) +
                        ": error: the points take 16 bytes where the header declares 24"));
}

TEST(PcdFormat, RefusesCompressedDataThatLie) {
  const std::string head = header("x y z", "4 4 4", "F F F", 1, "binary_compressed");
  const std::string lzf = storedAsLzf(bytesOfAll(1.F, 2.F, 3.F));
  const auto size = static_cast<std::uint32_t>(lzf.size());
  EXPECT_THAT(parsePcd(head + bytesOfAll(size, 12U) + lzf, "a").points.y, ElementsAre(2.F));
  EXPECT_THAT(refusalOf([&] { parsePcd(head + bytesOfAll(size, 13U) + lzf, "a"); }),
              HasSubstr("the size of the unpacked data, 13,"));
  EXPECT_THAT(refusalOf([&] { parsePcd(head + bytesOfAll(size + 1, 12U) + lzf, "a"); }),
              HasSubstr("bytes where the header declares"));
  std::string damaged = lzf;
  damaged[0] = static_cast<char>(0xFF);
  EXPECT_THAT(refusalOf([&] { parsePcd(head + bytesOfAll(size, 12U) + damaged, "a"); }),
              HasSubstr("PCL cannot decode it"));
  const std::string bomb =
      header("x y z", "4 4 4", "F F F", 300'000'000, "binary_compressed") + bytesOfAll(4U, 3'600'000'000U) + "abcd";
  EXPECT_THAT(refusalOf([&] { parsePcd(bomb, "a"); }), HasSubstr("does not fit the header or the compressed data"));
}

struct RefusedText {
  std::string bytes;
  const char* words;
};

class RefusedPcd : public testing::TestWithParam<RefusedText> {};

TEST_P(RefusedPcd, NamesTheFault) {
  EXPECT_THAT(refusalOf([] { parsePcd(GetParam().bytes, "a.pcd"); }), HasSubstr(GetParam().words));
}

const std::string kBody = "1 2 3\n";

INSTANTIATE_TEST_SUITE_P(
    AllFaults, RefusedPcd,
    testing::Values(
        RefusedText{"", "ends without a DATA line"}, RefusedText{"PK\x03\x04zip", "a.pcd:1"},
        RefusedText{header("x y", "4 4", "F F", 1, "ascii") + kBody, "has no field 'z'"},
        RefusedText{header("x y z x", "4 4 4 4", "F F F F", 1, "ascii") + kBody, "field 'x' occurs twice"},
        RefusedText{header("x y z", "4 4", "F F F", 1, "ascii") + kBody, "a.pcd:4:9: error: the line ends where SIZE"},
        RefusedText{header("x y z", "4 4 3", "F F F", 1, "ascii") + kBody, "no field has TYPE F and SIZE 3"},
        RefusedText{header("x y z", "4 4 4", "F F Q", 1, "ascii") + kBody, "unknown TYPE"},
        RefusedText{header("x y z", "4 4 4", "F F F", 0, "ascii"), "holds no points"},
        RefusedText{header("x y z", "4 4 4", "F F F", 2, "ascii") + kBody, "ends after 1 of 2 points"},
        RefusedText{header("x y z", "4 4 4", "F F F", 1, "ascii") + kBody + kBody,
                    "a.pcd:12:1: error: more points than the header's 1"},
        RefusedText{header("x y z", "4 4 4", "F F F", 1, "ascii") + "1 nan 3\n",
                    "none of its 1 points has a finite position"},
        RefusedText{header("x y z", "4 4 4", "F F F", 1, "zipped") + kBody, "unknown DATA"},
        RefusedText{header("x y z", "4 4 4", "F F F", 1, "ascii", "0 0 0 2 0 0 0") + kBody,
                    "VIEWPOINT does not have length 1"},
        RefusedText{header("x y z label", "4 4 4 4", "F F F F", 1, "ascii") + "1 2 3 1.5\n",
                    "has a label that is not a whole number"},
        RefusedText{"FIELDS x y z\nFIELDS x y z\n", "a.pcd:2:7: error: FIELDS stands twice"},
        RefusedText{header("x y z", "4 4 4", "F F F", 1, "binary") + std::string(13, 'a'),
                    "take 13 bytes where the header declares 12"}));

TEST(PcdFormat, RefusesBinaryNumbersOutOfRangeNamingTheByte) {
  const std::string head = header("x y z", "4 4 4", "F F F", 2, "binary");
  const std::string bytes = head + bytesOfAll(1.F, 2.F, 3.F, 4.F, 1e11F, 6.F);
  EXPECT_THAT(refusalOf([&] { parsePcd(bytes, "a.pcd"); }),
              HasSubstr("byte " + std::to_string(head.size() + 12) + ": error: point 1 has a coordinate beyond"));
}

TEST(PcdFormat, TakesIntensityOfAnOusterAndIgnoresReflectivity) {
  const std::string bytes =
      header("x y z reflectivity intensity t ring ambient range near_ir", "4 4 4 2 4 4 2 2 4 2", "F F F U F U U U U U",
             1, "binary") +
      bytesOfAll(1.F, 2.F, 3.F, std::uint16_t{9}, 0.5F, 7U, std::uint16_t{1}, std::uint16_t{2}, 3U, std::uint16_t{4});
  const ParsedScan scan = parsePcd(bytes, "ouster.pcd");
  EXPECT_THAT(scan.points.intensity, ElementsAre(0.5F));
  EXPECT_THAT(scan.ignored_fields, ElementsAre("reflectivity"));
}

TEST(PcdFormat, SkipsTheDirectionsOfAnOrganisedCloudWithoutAReturn) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::string head = header("x y z intensity", "4 4 4 4", "F F F F", 4, "binary");
  head.replace(head.find("WIDTH 4\nHEIGHT 1"), 16, "WIDTH 2\nHEIGHT 2");
  const ParsedScan scan = parsePcd(
      head + bytesOfAll(nan, nan, nan, nan, 1.F, 2.F, 3.F, 0.5F, 0.F, 0.F, 0.F, 0.F, 4.F, 5.F, 6.F, 0.25F), "a.pcd");
  EXPECT_THAT(scan.points.x, ElementsAre(1.F, 4.F));
  EXPECT_THAT(scan.points.intensity, ElementsAre(0.5F, 0.25F));
  EXPECT_THAT(scan.no_return, ElementsAre(0U, 2U));
}

TEST(PcdFormat, PrintsNothing) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const std::string head = header("x y z", "4 4 4", "F F F", 1, "binary_compressed");
  EXPECT_THROW(parsePcd(head + bytesOfAll(4U, 12U) + "\xFF\xFF\xFF\xFF", "a"), InputError);
  EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace cluxel::scan
