// SPDX-License-Identifier: Apache-2.0
// Tests of valid and faulty PLY headers and bodies.
#include "scan/formats/ply_format.hpp"

#include <algorithm>
#include <limits>

#include "scan/scan_fixture.hpp"
#include "scan/scan_summary.hpp"

namespace cluxel::scan {
namespace {

using test::bytesOfAll;
using test::refusalOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

std::string header(const std::string& format, int vertices, const std::string& properties,
                   const std::string& rest = "") {
  return "ply\nformat " + format + " 1.0\ncomment made here # with a hash\nobj_info nothing\nelement vertex " +
         std::to_string(vertices) + "\n" + properties + rest + "end_header\n";
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

std::string reversedFloats(const std::string& bytes) {
  std::string reversed = bytes;
  for (std::size_t at = 0; at < reversed.size(); at += 4)
    std::reverse(reversed.begin() + static_cast<std::ptrdiff_t>(at),
                 reversed.begin() + static_cast<std::ptrdiff_t>(at) + 4);
  return reversed;
}

TEST(PlyFormat, ReadsTextAndBothByteOrdersAlike) {
  const std::string properties = kXyz + "property float scalar_intensity\n";
  const std::string body = bytesOfAll(1.F, 2.F, 3.F, 0.5F, 4.F, 5.F, 6.F, 0.25F);
  for (const std::string& bytes : {header("ascii", 2, properties) + "1 2 3 0.5\n4 5 6 0.25\n",
                                   header("binary_little_endian", 2, properties) + body,
                                   header("binary_big_endian", 2, properties) + reversedFloats(body)}) {
    const ParsedScan scan = parsePly(bytes, "a.ply");
    EXPECT_THAT(scan.points.x, ElementsAre(1.F, 4.F));
    EXPECT_THAT(scan.points.z, ElementsAre(3.F, 6.F));
    EXPECT_THAT(scan.points.intensity, ElementsAre(0.5F, 0.25F));
  }
}

TEST(PlyFormat, TakesPropertiesOfAnyTypeOrderAndConvention) {
  const std::string bytes =
      header("binary_little_endian", 1,
             "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty double z\n"
             "property double y\nproperty double x\nproperty short Label\nproperty int32 reflectance\n") +
      bytesOfAll(std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{3}, 3.0, 2.0, 1.0, std::int16_t{9}, 70);
  const ParsedScan scan = parsePly(bytes, "a.ply");
  EXPECT_THAT(scan.points.x, ElementsAre(1.F));
  EXPECT_THAT(scan.points.z, ElementsAre(3.F));
  EXPECT_THAT(scan.points.label, ElementsAre(9U));
  EXPECT_THAT(scan.points.intensity, ElementsAre(70.F));
}

TEST(PlyFormat, SaysThatItIgnoresAPartOfAnOrigin) {
  const test::ScratchFolder folder;
  const auto part =
      folder.write("part.ply", header("ascii", 1, kXyz + "property float VP_X\nproperty float vp_z\n") + "1 2 3 4 5\n");
  const auto whole = folder.write(
      "whole.ply",
      header("ascii", 1, kXyz + "property float vp_x\nproperty float vp_y\nproperty float vp_z\n") + "1 2 3 4 5 6\n");
  test::NoteKeeper sink;
  const ScanSetSummary of_part = summarize(ScanSet::open({part}, {}, sink));
  EXPECT_FALSE(of_part.scans[0].has_origins);
  EXPECT_THAT(of_part.notes, ElementsAre("ignored fields: VP_X, vp_z: where a ray starts takes all of vp_x, vp_y and "
                                         "vp_z (" +
                                         part.string() + ")"));
  const ScanSetSummary of_whole = summarize(ScanSet::open({whole}, {}, sink));
  EXPECT_TRUE(of_whole.scans[0].has_origins);
  EXPECT_THAT(of_whole.notes, ElementsAre());
}

/// Poses and headers are read before the points.
TEST(PlyFormat, MayTellWhereRaysStartWithoutAPose) {
  const test::ScratchFolder folder;
  test::NoteKeeper of_ply, of_xyz;
  ScanSet::open({folder.write("a.ply", header("ascii", 1, kXyz) + "1 2 3\n")}, {}, of_ply);
  ScanSet::open({folder.write("b.xyz", "1 2 3\n")}, {}, of_xyz);
  EXPECT_THAT(of_ply.notes, ElementsAre(EndsWith("the position of the sensor is unknown unless the points state where "
                                                 "rays start (vp_x, vp_y, vp_z)")));
  EXPECT_THAT(of_xyz.notes, ElementsAre(EndsWith("the position of the sensor is unknown")));
}

TEST(PlyFormat, KeepsMillimetresOfWorldCoordinatesInDoubles) {
  const std::string bytes =
      header("binary_little_endian", 1, "property double x\nproperty double y\nproperty double z\n") +
      bytesOfAll(456123.123, 5412345.125, 230.5);
  const ParsedScan scan = parsePly(bytes, "a.ply");
  EXPECT_NEAR(scan.local_origin.y() + scan.points.y[0], 5412345.125, 1e-4);
}

TEST(PlyFormat, MovesOriginsOfRaysWithTheLocalOrigin) {
  const std::string bytes =
      header("binary_little_endian", 1,
             "property double vp_x\nproperty double vp_y\nproperty double vp_z\nproperty double x\n"
             "property double y\nproperty double z\n") +
      bytesOfAll(456000.125, 5412001.5, 2.0, 456123.123, 5412345.125, 230.5);
  const ParsedScan scan = parsePly(bytes, "a.ply");
  EXPECT_EQ(scan.points.origin.at(0) + scan.local_origin.cast<float>() - Eigen::Vector3f(456000, 5412000, 0),
            Eigen::Vector3f(0.125F, 1.5F, 2));
}

TEST(PlyFormat, PassesOverOtherElements) {
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string camera = "element camera 1\nproperty float f\n";
  const std::string body = bytesOfAll(1.F, 2.F, 3.F);
  EXPECT_THAT(
      parsePly(header("binary_little_endian", 1, kXyz, faces) + body + bytesOfAll(std::uint8_t{1}, 0), "a").points.y,
      ElementsAre(2.F));
  const std::string head =
      "ply\nformat binary_little_endian 1.0\n" + camera + "element vertex 1\n" + kXyz + "end_header\n";
  EXPECT_THAT(parsePly(head + bytesOfAll(9.F) + body, "a").points.y, ElementsAre(2.F));
  const std::string text =
      "ply\nformat ascii 1.0\n" + camera + "element vertex 1\n" + kXyz + faces + "end_header\n9\n1 2 3\n3 0 0 0\n";
  EXPECT_THAT(parsePly(text, "a").points.y, ElementsAre(2.F));
}

TEST(PlyFormat, RefusesEveryPrefixOfABinaryFile) {
  const std::string bytes = header("binary_little_endian", 2, kXyz) + bytesOfAll(1.F, 2.F, 3.F, 4.F, 5.F, 6.F);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_THROW(parsePly(std::string_view(bytes).substr(0, length), "a.ply"), InputError) << length;
}

TEST(PlyFormat, RefusesBinaryNumbersOutOfRangeNamingTheByte) {
  const std::string head = header("binary_little_endian", 2, kXyz);
  const std::string bytes = head + bytesOfAll(1.F, 2.F, 3.F, 4.F, 5.F, 1e11F);
  EXPECT_THAT(refusalOf([&] { parsePly(bytes, "a.ply"); }),
              HasSubstr("byte " + std::to_string(head.size() + 12) + ": error: point 1 has a coordinate beyond"));
}

struct RefusedPlyText {
  std::string bytes;
  const char* words;
};

class RefusedPly : public testing::TestWithParam<RefusedPlyText> {};

TEST_P(RefusedPly, NamesTheFault) {
  EXPECT_THAT(refusalOf([] { parsePly(GetParam().bytes, "a.ply"); }), HasSubstr(GetParam().words));
}

INSTANTIATE_TEST_SUITE_P(
    AllFaults, RefusedPly,
    testing::Values(
        RefusedPlyText{"", "its first line is not 'ply'"}, RefusedPlyText{"ply\n", "ends without a line end_header"},
        RefusedPlyText{header("ascii", 0, kXyz), "holds no points"},
        RefusedPlyText{header("ascii", 2, kXyz) + "1 2 3\n", "ends after 1 of 2 points"},
        RefusedPlyText{header("ascii", 1, kXyz) + "1 2 3\n4 5 6\n", "more points than the header's 1"},
        RefusedPlyText{header("ascii", 1, kXyz) + "1 2 inf\n", "none of its 1 points has a finite position"},
        RefusedPlyText{header("binary_little_endian", 1, kXyz) + std::string(14, 'a'),
                       "2 bytes follow the last vertex"},
        RefusedPlyText{header("binary_little_endian", 2'000'000'000, kXyz) + "abc",
                       "the vertices take 3 bytes where the header declares 24000000000"},
        RefusedPlyText{header("ascii", 1, "property float x\nproperty float y\n") + "1 2\n", "has no field 'z'"},
        RefusedPlyText{header("ascii", 1, kXyz + "property list uchar int n\n") + "1 2 3 0\n", "'vertex' has lists"},
        RefusedPlyText{header("ascii", 1, "property half x\n") + "1 2\n", "'half' is not a type of PLY"},
        RefusedPlyText{header("binary_middle_endian", 1, kXyz), "unknown format"},
        RefusedPlyText{"ply\nformat ascii 1.0\nproperty float x\nend_header\n", "stands before the first element"},
        RefusedPlyText{"ply\nformat ascii 1.0\nelement face 1\nproperty float x\nend_header\n1\n",
                       "has no element 'vertex'"},
        RefusedPlyText{"ply\nelement vertex 1\n" + kXyz + "end_header\n1 2 3\n", "the header has no line format"}));

}  // namespace
}  // namespace cluxel::scan
