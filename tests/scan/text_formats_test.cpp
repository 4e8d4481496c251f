// SPDX-License-Identifier: Apache-2.0
// Tests of the text formats and of their error messages.
#include "scan/formats/text_formats.hpp"

#include "scan/scan_fixture.hpp"

namespace cluxel::scan {
namespace {

using test::refusalOf;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(XyzText, ReadsPointsWithAndWithoutIntensity) {
  const ParsedScan bare = parseXyzText("1 2 3\n-4.5 5e-1 +6\n", "a.xyz");
  EXPECT_THAT(bare.points.x, ElementsAre(1.0F, -4.5F));
  EXPECT_THAT(bare.points.y, ElementsAre(2.0F, 0.5F));
  EXPECT_THAT(bare.points.z, ElementsAre(3.0F, 6.0F));
  EXPECT_TRUE(bare.points.intensity.empty());
  const ParsedScan lit = parseXyzText("1 2 3 0.5\n4 5 6 0.25\n", "a.xyz");
  EXPECT_THAT(lit.points.intensity, ElementsAre(0.5F, 0.25F));
}

TEST(XyzText, SkipsCommentsEmptyLinesCarriageReturnsAndCommas) {
  const ParsedScan scan = parseXyzText("# head\r\n\r\n1,2,3 # tail\r\n \t\n4\t5 6\r\n", "a.xyz");
  EXPECT_THAT(scan.points.z, ElementsAre(3.0F, 6.0F));
}

TEST(XyzText, PassesOverAByteOrderMark) {
  EXPECT_THAT(parseXyzText("\xEF\xBB\xBF"
                           "1 2 3\n4 5 6\n",
                           "a.xyz")
                  .points.x,
              ElementsAre(1.0F, 4.0F));
  EXPECT_THAT(refusalOf([] { parseXyzText("\xEF\xBB\xBF", "a.xyz"); }), HasSubstr("holds no points"));
  EXPECT_EQ(columnsOfFirstLine("\xEF\xBB\xBF# x y z\n1 2 3\n"), 3U);
}

TEST(XyzText, KeepsMillimetresOfWorldCoordinatesByALocalOrigin) {
  const ParsedScan scan = parseXyzText("456123.123 5412345.125 230.5\n456124.001 5412345.002 230.5\n", "utm.xyz");
  EXPECT_EQ(scan.local_origin, Eigen::Vector3d(456000, 5412000, 0));
  EXPECT_NEAR(scan.local_origin.x() + scan.points.x[1], 456124.001, 1e-4);
  EXPECT_NEAR(scan.local_origin.y() + scan.points.y[1], 5412345.002, 1e-4);
}

TEST(XyzText, LeavesCoordinatesWithinTheReachOfFloatsAsTheyAre) {
  EXPECT_TRUE(parseXyzText("4096 -4096 0\n", "a.xyz").local_origin.isZero(0));
}

/// A decimal comma would make two columns of one number.
TEST(XyzText, RefusesDecimalCommasAndMissingValues) {
  const auto refusal = [](const std::string& text) { return refusalOf([&] { parseXyzText(text, "a.xyz"); }); };
  EXPECT_THAT(refusal("1 2 3\n1,5 2 3\n"), HasSubstr("a.xyz:2:4: error: the line mixes commas and blanks"));
  EXPECT_THAT(refusal("1,5 2,5 3,5\n"), HasSubstr("write decimals with a point"));
  EXPECT_THAT(refusal("1,5\t2,5\n"), HasSubstr("the line mixes commas and blanks"));
  EXPECT_THAT(refusal("1,,2,3\n"), HasSubstr("a.xyz:1:2: error: a value is missing between two commas"));
  EXPECT_THAT(refusal(",1,2,3\n"), HasSubstr("a value is missing before the first comma"));
  EXPECT_THAT(parseXyzText("1, 2,\t3 # a, b c\n4 ,5 , 6,\n7 8 9\n", "a.xyz").points.z, ElementsAre(3.0F, 6.0F, 9.0F));
}

/// Every cut of a text of numbers is an error, or ends with a whole line.
TEST(XyzText, RefusesANumberThatTheEndOfTheFileMayHaveCut) {
  const std::string text = "1.25 2.5 3.75\n-4.5 5.125 6.0625\n";
  for (std::size_t size = 1; size < text.size(); ++size) {
    if (text[size - 1] == '\n') {
      EXPECT_EQ(parseXyzText(text.substr(0, size), "a.xyz").points.size(), 1U);
      continue;
    }
    EXPECT_NE(refusalOf([&] { parseXyzText(text.substr(0, size), "a.xyz"); }), "") << size;
  }
  EXPECT_THAT(refusalOf([&] { parseXyzText("1 2 3.7", "a.xyz"); }),
              HasSubstr("a.xyz:1:5: error: the file ends with z '3.7', which may be cut"));
}

struct RefusedLine {
  const char* text;
  const char* words;
};

class RefusedXyz : public testing::TestWithParam<RefusedLine> {};

TEST_P(RefusedXyz, NamesThePlaceAndTheFault) {
  EXPECT_THAT(refusalOf([] { parseXyzText(GetParam().text, "a.xyz"); }), HasSubstr(GetParam().words));
}

INSTANTIATE_TEST_SUITE_P(
    AllFaults, RefusedXyz,
    testing::Values(RefusedLine{"", "a.xyz:1:1: error: holds no points"}, RefusedLine{"# only\n", "holds no points"},
                    RefusedLine{"1 2 3\n1 2\n", "a.xyz:2:4: error: the line ends where z was expected"},
                    RefusedLine{"1 2 nan\n", "a.xyz: error: none of its 1 points has a finite position"},
                    RefusedLine{"1 2 3 nan\n", "a.xyz:1:7: error: intensity is not finite: 'nan'"},
                    RefusedLine{"1 2 3\n4 x5 6\n", "a.xyz:2:3: error: y is not a number: 'x5'"},
                    RefusedLine{"1 2.5m 3\n", "a.xyz:1:3: error: y is not a number: '2.5m'"},
                    RefusedLine{"1 2 1e999\n", "z is out of range"},
                    RefusedLine{"+-1 2 3\n", "a.xyz:1:1: error: x is not a number: '+-1'"},
                    RefusedLine{"1e39 2 3\n", "a.xyz:1:9: error: the point has a coordinate beyond 10000 km, even in"},
                    RefusedLine{"1 2 3\n1 2 3 4\n", "a.xyz:2:7: error: unexpected '4'"},
                    RefusedLine{"1 2 3 4\n1 2 3\n", "a.xyz:2:6: error: the line ends where intensity was expected"},
                    RefusedLine{"1 2 3 4 5\n", "unexpected '5'"}));

TEST(LabelledText, ReadsTheLayoutOfOakland) {
  const ParsedScan scan =
      parseLabelledText("#File format: x y z label_id confidence \n-23.09 -9.4 0.69 1111 2\n1 2 3 0 1\n", "a");
  EXPECT_THAT(scan.points.label, ElementsAre(1111U, 0U));
  EXPECT_FLOAT_EQ(scan.points.x[0], -23.09F);
}

TEST(LabelledText, RefusesLabelsThatAreNoWholeNumbers) {
  EXPECT_THAT(refusalOf([] { parseLabelledText("1 2 3 1.5 2\n", "a"); }),
              HasSubstr("a:1:7: error: label is not a number: '1.5'"));
  EXPECT_THAT(refusalOf([] { parseLabelledText("1 2 3 -2 2\n", "a"); }),
              HasSubstr("label is not a whole number from 0 to 4294967294, or -1 for none: '-2'"));
  EXPECT_THAT(refusalOf([] { parseLabelledText("1 2 3 -12 2\n", "a"); }), HasSubstr("label is not a whole number"));
  EXPECT_THAT(refusalOf([] { parseLabelledText("1 2 3 4294967296 2\n", "a"); }),
              HasSubstr("label is not a whole number"));
  EXPECT_THAT(refusalOf([] { parseLabelledText("1 2 3 7\n", "a"); }), HasSubstr("confidence"));
}

TEST(LabelledText, TakesMinusOneForNoLabel) {
  EXPECT_THAT(parseLabelledText("1 2 3 -1 2\n1 2 3 7 2\n", "a").points.label, ElementsAre(kNoLabel, 7U));
  EXPECT_THAT(parseLabelLines("-1\n0\n", "l", 2), ElementsAre(kNoLabel, 0U));
}

TEST(FreiburgText, KeepsTheOriginOfEachRay) {
  const ParsedScan scan = parseFreiburgPoints("0.1 0.2 0.3 1 2 3\n0.1 0.2 0.4 4 5 6\n", "scan_0_points.dat");
  ASSERT_EQ(scan.points.origin.size(), 2U);
  EXPECT_EQ(scan.points.origin[1], Eigen::Vector3f(0.1F, 0.2F, 0.4F));
  EXPECT_THAT(scan.points.x, ElementsAre(1.0F, 4.0F));
}

TEST(FreiburgText, MovesOriginsOfRaysWithTheLocalOrigin) {
  const ParsedScan scan = parseFreiburgPoints("456000.125 5412001.5 2 456010 5412020 3\n", "scan_0_points.dat");
  EXPECT_EQ(scan.points.origin.at(0), Eigen::Vector3f(0.125F, 1.5F, 2));
}

TEST(FreiburgText, RefusesALineOfFiveNumbers) {
  EXPECT_THAT(refusalOf([] { parseFreiburgPoints("0 0 0 1 2\n", "p.dat"); }),
              HasSubstr("p.dat:1:10: error: the line ends where z"));
}

TEST(LabelLines, MustBeAsManyAsThePoints) {
  EXPECT_THAT(parseLabelLines("1\n2\n", "l", 2), ElementsAre(1U, 2U));
  EXPECT_THAT(refusalOf([] { parseLabelLines("1\n2\n", "l", 3); }), HasSubstr("ends after 2 labels for 3 points"));
  EXPECT_THAT(refusalOf([] { parseLabelLines("1\n2\n", "l", 1); }),
              HasSubstr("l:2:1: error: more labels than the scan's 1 points"));
}

}  // namespace
}  // namespace cluxel::scan
