// SPDX-License-Identifier: Apache-2.0
// Tests of typical problems of real files: missing poses, unrelated trajectories, units, axes, coordinate systems.
#include "scan/formats/las_crs.hpp"
#include "scan/scan_fixture.hpp"
#include "scan/scan_set.hpp"
#include "scan/scan_summary.hpp"

namespace cluxel::scan {
namespace {

using test::bytesOfAll;
using test::NoteKeeper;
using test::refusalOf;
using test::ScratchFolder;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kBin = bytesOfAll(1.F, 2.F, 3.F, 0.5F);

TEST(RealFiles, OneBinFileOfAFolderIsReadWithoutAPose) {
  const ScratchFolder folder;
  folder.write("cloud.bin", kBin);
  NoteKeeper notes;
  const ScanSet set = ScanSet::open({folder.path()}, {}, notes);
  ASSERT_EQ(set.size(), 1U);
  EXPECT_FALSE(set.file(0).has_pose);
  EXPECT_THAT(set.load(0).points.y, ElementsAre(2.F));
}

TEST(RealFiles, SeveralBinFilesOfAFolderNeedPoses) {
  const ScratchFolder folder;
  folder.write("000000.bin", kBin);
  folder.write("000001.bin", kBin);
  NoteKeeper notes;
  EXPECT_THAT(refusalOf([&] { ScanSet::open({folder.path()}, {}, notes); }),
              testing::AllOf(HasSubstr("000000.bin: error: has no pose"), HasSubstr("name a poses file")));
  folder.write("poses.txt", "1 0 0 5 0 1 0 0 0 0 1 0\n1 0 0 9 0 1 0 0 0 0 1 0\n");
  const ScanSet set = ScanSet::open({folder.path()}, {}, notes);
  EXPECT_EQ(set.file(1).T_map_sensor.translation().x(), 9);
}

TEST(RealFiles, AnUnrelatedTumFileIsANoteForASingleScanAndAnErrorForTheFolder) {
  const ScratchFolder folder;
  const auto file = folder.write("a.xyz", "1 2 3\n");
  folder.write("other.tum", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n");
  NoteKeeper notes;
  const ScanSet set = ScanSet::open({file}, {}, notes);
  EXPECT_FALSE(set.file(0).has_pose);
  EXPECT_THAT(notes.notes, Contains(HasSubstr("a .tum file lies beside it, but is not used: has 2 poses for 1 scans")));
  EXPECT_THAT(refusalOf([&] { ScanSet::open({folder.path()}, {}, notes); }), HasSubstr("has 2 poses for 1 scans"));
}

TEST(RealFiles, SkippedReturnsTakeTheirLabelsWithThemAndAreCounted) {
  const ScratchFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  folder.write("velodyne/000000.bin", bytesOfAll(nan, nan, nan, 0.F) + kBin);
  folder.write("labels/000000.label", bytesOfAll(40U, 81U));
  NoteKeeper notes;
  const ScanSet set = ScanSet::open({folder.path()}, {}, notes);
  EXPECT_THAT(set.load(0).points.label, ElementsAre(81U));
  EXPECT_THAT(summarize(set).notes, Contains(HasSubstr("1 records without a finite position (no return) skipped")));
}

TEST(RealFiles, UnitAndUpAxisConvertPointsAndPosesAlike) {
  const ScratchFolder folder;
  const auto file = folder.write("a.xyz", "10 20 30\n");
  NoteKeeper notes;
  const InputFrame frame{LengthUnit::Foot, UpAxis::Y};
  const Scan plain = ScanSet::open({file}, {.poses = {}, .frame = frame}, notes).load(0);
  EXPECT_FLOAT_EQ(plain.points.x[0], 3.048F);
  EXPECT_FLOAT_EQ(plain.points.y[0], -9.144F);
  EXPECT_FLOAT_EQ(plain.points.z[0], 6.096F);
  Eigen::Isometry3d pose(Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()));
  pose.translation() = Eigen::Vector3d(4, 5, 6);
  const Eigen::Vector3d p(1, 2, 3);
  EXPECT_TRUE(
      (toMetresZUp(pose, frame) * toMetresZUp(p, frame)).isApprox(toMetresZUp(Eigen::Vector3d(pose * p), frame)));
}

/// A ground of 40 m x 40 m with a wall of 3 m height along x; coordinates are written in `order`.
std::string sceneText(const std::array<int, 3>& order) {
  std::string text;
  const auto add = [&](double x, double y, double z) {
    const std::array p{x, y, z};
    for (const int axis : order) text += std::to_string(p[static_cast<std::size_t>(axis)]) + ' ';
    text += '\n';
  };
  for (int i = 0; i < 80; ++i)
    for (int j = 0; j < 80; ++j) add(0.5 * i, 0.5 * j, 0);
  for (int i = 0; i < 80; ++i)
    for (int j = 0; j < 12; ++j) add(0.5 * i, 10, 0.25 * j);
  return text;
}

TEST(RealFiles, WarnsOfACloudWithYUpAndOfOneInMillimetres) {
  const ScratchFolder folder;
  const auto upright = folder.write("z_up.xyz", sceneText({0, 1, 2}));
  const auto lying = folder.write("y_up.xyz", sceneText({0, 2, 1}));
  const auto large = folder.write("millimetres.xyz", "0 0 0\n121000 0 3000\n");
  NoteKeeper notes;
  const auto notesOf = [&](const std::filesystem::path& file) {
    return summarize(ScanSet::open({file}, {}, notes)).notes;
  };
  EXPECT_THAT(notesOf(upright), IsEmpty());
  EXPECT_THAT(notesOf(lying), ElementsAre(HasSubstr("state that y is the up axis of the input")));
  EXPECT_THAT(notesOf(large), ElementsAre(HasSubstr("state the unit of the input")));
}

std::string geoKeys(std::uint16_t projected, std::uint16_t unit) {
  const auto key = [](std::uint16_t id, std::uint16_t value) {
    return bytesOfAll(id, std::uint16_t{0}, std::uint16_t{1}, value);
  };
  return bytesOfAll(std::uint16_t{1}, std::uint16_t{1}, std::uint16_t{0}, std::uint16_t{3}) + key(1024, 1) +
         key(3072, projected) + key(3076, unit);
}

TEST(LasCrs, IsReadFromGeoTiffKeys) {
  const LasCrs crs = crsFromGeoKeys(geoKeys(2249, 9003));
  EXPECT_EQ(crs.crs, "EPSG:2249");
  EXPECT_EQ(crs.unit, LengthUnit::UsSurveyFoot);
  EXPECT_THAT(crsFromGeoKeys(geoKeys(32767, 9001)).fault, HasSubstr("no EPSG code"));
}

TEST(LasCrs, HasTheUnitOfItsCodeWhenTheFileStatesNone) {
  const LasCrs feet = crsFromGeoKeys(geoKeys(2263, 0));
  EXPECT_EQ(feet.unit, std::nullopt);
  EXPECT_EQ(unitOf(feet), LengthUnit::UsSurveyFoot);
  EXPECT_EQ(unitOf(crsFromGeoKeys(geoKeys(25832, 0))), LengthUnit::Metre);
  EXPECT_EQ(unitOf(crsFromGeoKeys(geoKeys(25832, 9002))), LengthUnit::Foot) << "what the file states comes first";
  EXPECT_EQ(unitOf(crsFromGeoKeys(geoKeys(60000, 0))), std::nullopt) << "PROJ knows no such code";
}

TEST(LasCrs, IsReadFromWkt) {
  const std::string geographic =
      R"(GEOGCS["NAD83",DATUM["d",SPHEROID["s",6378137,298.2]],UNIT["degree",0.0174532925],AUTHORITY["EPSG","4269"]])";
  const std::string unit = R"(UNIT["US survey foot",0.3048006096012192,AUTHORITY["EPSG","9003"]])";
  const LasCrs named = crsFromWkt(R"(COMPD_CS["c",PROJCS["p",)" + geographic + ',' + unit +
                                  R"(,AUTHORITY["EPSG","2249"]],VERT_CS["v",UNIT["metre",1]]])");
  EXPECT_EQ(named.crs, "EPSG:2249");
  EXPECT_EQ(named.unit, LengthUnit::UsSurveyFoot);
  const std::string unnamed = "PROJCS[\"p\"," + geographic + ',' + unit + ']';
  EXPECT_EQ(crsFromWkt(unnamed + '\0').crs, unnamed) << "without an identifier the text itself is kept";
  EXPECT_TRUE(crsFromWkt(geographic).is_geographic);
}

template <typename T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// LAS 1.2, one point at the origin, with one GeoKeyDirectory record.
std::string lasWithKeys(const std::string& keys) {
  std::string bytes(227, '\0');
  bytes.replace(0, 4, "LASF");
  bytes[24] = 1, bytes[25] = 2;
  put<std::uint16_t>(bytes, 94, 227);
  put(bytes, 96, static_cast<std::uint32_t>(227 + 54 + keys.size()));
  put<std::uint32_t>(bytes, 100, 1);
  put<std::uint16_t>(bytes, 105, 20);
  put<std::uint32_t>(bytes, 107, 1);
  for (const std::size_t axis : {0U, 1U, 2U}) put(bytes, 131 + 8 * axis, 0.001);
  std::string record(54, '\0');
  record.replace(2, 15, "LASF_Projection");
  put<std::uint16_t>(record, 18, 34735);
  put(record, 20, static_cast<std::uint16_t>(keys.size()));
  return bytes + record + keys + std::string(20, '\0');
}

TEST(LasCrs, BecomesTheSystemOfTheSetAndAForeignUnitIsNoted) {
  const ScratchFolder folder;
  const auto file = folder.write("a.las", lasWithKeys(geoKeys(2249, 9003)));
  NoteKeeper notes;
  const ScanSet set = ScanSet::open({file}, {}, notes);
  EXPECT_EQ(set.crs(), "EPSG:2249");
  EXPECT_EQ(summarize(set).crs, "EPSG:2249");
  EXPECT_THAT(notes.notes, Contains(HasSubstr("the unit of its coordinate system is us-ft, but")));
  NoteKeeper by_code;
  ScanSet::open({folder.write("c.las", lasWithKeys(geoKeys(2263, 0)))}, {}, by_code);
  EXPECT_THAT(by_code.notes, Contains(HasSubstr("the unit of its coordinate system is us-ft, but")));
  EXPECT_EQ(ScanSet::open({file}, {.poses = {}, .frame = {LengthUnit::UsSurveyFoot}}, notes).crs(), "")
      << "converted coordinates are not those of the system";
  const auto other = folder.write("b.las", lasWithKeys(geoKeys(25832, 9001)));
  EXPECT_THAT(refusalOf([&] { ScanSet::open({file, other}, {}, notes); }), HasSubstr("has another coordinate system"));
}

}  // namespace
}  // namespace cluxel::scan
