// SPDX-License-Identifier: Apache-2.0
// Tests which scans a set of files, folders and layouts gives.
#include "scan/scan_set.hpp"

#include <sys/stat.h>

#include "scan/scan_fixture.hpp"
#include "scan/scan_summary.hpp"

namespace cluxel::scan {
namespace {

using test::bytesOfAll;
using test::NoteKeeper;
using test::refusalOf;
using test::ScratchFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

const std::string kAt0 = "1 0 0 0 0 1 0 0 0 0 1 0\n";
const std::string kAt5 = "1 0 0 5 0 1 0 0 0 0 1 0\n";
const std::string kAt9 = "1 0 0 9 0 1 0 0 0 0 1 0\n";

ScanSet opened(const std::vector<std::filesystem::path>& inputs, const ScanSetParams& params = {}) {
  ProgressSink silent;
  return ScanSet::open(inputs, params, silent);
}

std::vector<std::string> namesOf(const ScanSet& set) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < set.size(); ++i) names.push_back(set.file(i).path.filename().string());
  return names;
}

double xOf(const ScanSet& set, std::size_t i) {
  return set.file(i).T_map_sensor.translation().x();
}

TEST(ScanSet, ListsAFolderInNaturalOrderWithItsPoses) {
  const ScratchFolder folder;
  folder.write("scan_10.xyz", "1 2 3\n");
  folder.write("scan_2.xyz", "4 5 6\n");
  folder.write("poses.txt", kAt5 + kAt9);
  folder.write("times.txt", "0.5\n1.5\n");
  folder.write("README.md", "not a scan");
  const ScanSet set = opened({folder.path()});
  EXPECT_THAT(namesOf(set), ElementsAre("scan_2.xyz", "scan_10.xyz"));
  EXPECT_EQ(xOf(set, 0), 5);
  EXPECT_EQ(xOf(set, 1), 9);
  EXPECT_EQ(set.file(1).time_s, 1.5);
  const Scan scan = set.load(1);
  EXPECT_TRUE(scan.has_pose);
  EXPECT_EQ(toMap(scan.T_map_sensor, {scan.points.x[0], scan.points.y[0], scan.points.z[0]}),
            Eigen::Vector3d(10, 2, 3));
}

TEST(ScanSet, GivesAFileNamedAloneThePoseOfItsFolder) {
  const ScratchFolder folder;
  folder.write("a.xyz", "1 2 3\n");
  const auto file = folder.write("b.xyz", "4 5 6\n");
  folder.write("poses.txt", kAt5 + kAt9);
  const ScanSet alone = opened({file});
  ASSERT_EQ(alone.size(), 1U);
  EXPECT_EQ(xOf(alone, 0), 9);
  EXPECT_EQ(alone.load(0).id, opened({folder.path()}).load(1).id);
}

TEST(ScanSet, RefusesAFolderWhoseScansLackAPose) {
  const ScratchFolder folder;
  folder.write("a.xyz", "1 2 3\n");
  folder.write("b.xyz", "4 5 6\n");
  folder.write("poses.txt", kAt5);
  EXPECT_THAT(refusalOf([&] { opened({folder.path()}); }), HasSubstr("has no pose for"));
  folder.write("poses.txt", kAt5 + kAt5 + kAt5);
  EXPECT_THAT(refusalOf([&] { opened({folder.path()}); }), HasSubstr("has 3 poses for 2 scans"));
}

TEST(ScanSet, RefusesScansThatAreLinksToNowhere) {
  const ScratchFolder folder;
  folder.write("b.xyz", "0 0 0\n1 0 0\n");
  std::filesystem::create_symlink(folder.path() / "loop", folder.path() / "loop");  // no scan's name: nobody reads it
  EXPECT_EQ(opened({folder.path()}).size(), 1U);
  std::filesystem::create_symlink(folder.path() / "gone", folder.path() / "a.xyz");
  EXPECT_THAT(refusalOf([&] { opened({folder.path()}); }), HasSubstr("the link leads nowhere"));
}

TEST(ScanSet, MatchesTumPosesToTimesWithinTenMilliseconds) {
  const ScratchFolder folder;
  folder.write("a.xyz", "1 2 3\n");
  folder.write("b.xyz", "4 5 6\n");
  folder.write("times.txt", "10\n20\n");
  folder.write("path.tum", "20.004 7 0 0 0 0 0 1\n15 0 0 0 0 0 0 1\n9.996 3 0 0 0 0 0 1\n");
  const ScanSet set = opened({folder.path()});
  EXPECT_EQ(xOf(set, 0), 3);
  EXPECT_EQ(xOf(set, 1), 7);
  folder.write("times.txt", "10\n20.1\n");
  EXPECT_THAT(refusalOf([&] { opened({folder.path()}); }), HasSubstr("the nearest is 0.096 s away"));
}

TEST(ScanSet, TakesTimesFromTumPosesWhereTheScansHaveNone) {
  const ScratchFolder folder;
  folder.write("a.xyz", "1 2 3\n");
  folder.write("poses.tum", "12.25 7 0 0 0 0 0 1\n");
  EXPECT_EQ(opened({folder.path()}).file(0).time_s, 12.25);
}

TEST(ScanSet, GivesScansTimesOfWholeMicroseconds) {
  const ScratchFolder folder;
  folder.write("a.xyz", "1 2 3\n");
  folder.write("b.xyz", "1 2 3\n");
  folder.write("times.txt", "1700086400.1234567\n1700086400.25\n");
  const ScanSet set = opened({folder.path()});
  EXPECT_EQ(set.load(0).time_s, 1700086400.123457);
  EXPECT_EQ(set.load(1).time_s, 1700086400.25);
}

TEST(ScanSet, SaysOnceThatScansWithoutAPoseAreInTheMapFrame) {
  const ScratchFolder folder;
  folder.write("a.xyz", "1 2 3\n");
  folder.write("b.xyz", "4 5 6\n");
  NoteKeeper sink;
  const ScanSet set = ScanSet::open({folder.path()}, {}, sink);
  ASSERT_THAT(sink.notes, SizeIs(1));
  EXPECT_THAT(sink.notes[0], HasSubstr("2 of 2 scans have no pose"));
  EXPECT_FALSE(set.load(0).has_pose);
}

TEST(ScanSet, ReadsTheLayoutOfKittiOdometry) {
  const ScratchFolder folder;
  folder.write("velodyne/000001.bin", bytesOfAll(1.F, 2.F, 3.F, 0.5F));
  folder.write("velodyne/000003.bin", bytesOfAll(4.F, 5.F, 6.F, 0.5F));
  folder.write("labels/000003.label", bytesOfAll(0x00050051U));
  folder.write("poses.txt", kAt0 + kAt0 + kAt5 + "1 0 0 0 0 1 0 0 0 0 1 2\n");
  folder.write("calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  folder.write("times.txt", "0\n0.1\n0.2\n0.3\n");
  const ScanSet set = opened({folder.path()});
  EXPECT_THAT(namesOf(set), ElementsAre("000001.bin", "000003.bin"));
  EXPECT_TRUE(set.file(1).T_map_sensor.translation().isApprox(Eigen::Vector3d(2, 0, 0)));
  EXPECT_EQ(set.file(1).time_s, 0.3);
  EXPECT_THAT(set.load(1).points.label, ElementsAre(81U));
  EXPECT_TRUE(set.load(0).points.label.empty());
  const ScanSet alone = opened({folder.path() / "velodyne" / "000003.bin"});
  EXPECT_TRUE(alone.file(0).T_map_sensor.isApprox(set.file(1).T_map_sensor));
  EXPECT_EQ(alone.load(0).points.label, set.load(1).points.label);
  EXPECT_EQ(opened({folder.path() / "velodyne"}).size(), 2U);
}

TEST(ScanSet, TakesThePosesOfAKittiSequenceFromElsewhere) {
  const ScratchFolder folder;
  folder.write("seq/velodyne/000002.bin", bytesOfAll(1.F, 2.F, 3.F, 0.5F));
  folder.write("seq/calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  const auto poses = folder.write("00.txt", kAt0 + kAt0 + "1 0 0 0 0 1 0 0 0 0 1 4\n");
  const ScanSet set = opened({folder.path() / "seq"}, {.poses = poses});
  EXPECT_TRUE(set.file(0).T_map_sensor.translation().isApprox(Eigen::Vector3d(4, 0, 0)));
}

TEST(ScanSet, GivesNoPoseOfAKittiSequenceToAScanThatIsNotOfIt) {
  const ScratchFolder folder;
  folder.write("seq/velodyne/000001.bin", bytesOfAll(1.F, 2.F, 3.F, 0.5F));
  const auto extra = folder.write("extra.xyz", "1 2 3\n");
  const auto poses = folder.write("00.txt", kAt5 + kAt9);
  EXPECT_THAT(refusalOf([&] {
                opened({folder.path() / "seq", extra}, {.poses = poses});
              }),
              HasSubstr("extra.xyz does not belong to that sequence"));
  const auto seq = folder.path() / "seq";
  const ScanSet twice =
      opened({seq / "velodyne" / "000001.bin", seq / "." / "velodyne" / "000001.bin"}, {.poses = poses});
  EXPECT_EQ(xOf(twice, 1), 9);
}

TEST(ScanSet, ReadsAManifestThatListsItsOwnFolderAndRefusesTwoThatListEachOther) {
  const ScratchFolder folder;
  folder.write("a/a.xyz", "1 2 3\n");
  folder.write("a/manifest.yaml", "map_origin: [100, 0, 0]\nscans: [.]\n");
  const ScanSet own = opened({folder.path() / "a"});
  EXPECT_THAT(namesOf(own), ElementsAre("a.xyz"));
  EXPECT_EQ(own.mapOrigin().x(), 100);
  folder.write("b/manifest.yaml", "scans: [../c]\n");
  folder.write("c/manifest.yaml", "scans: [../b]\n");
  EXPECT_THAT(refusalOf([&] { opened({folder.path() / "b"}); }), HasSubstr("list each other's folders"));
}

TEST(ScanSet, RefusesAKittiScanBehindTheEndOfThePoses) {
  const ScratchFolder folder;
  folder.write("velodyne/000004.bin", bytesOfAll(1.F, 2.F, 3.F, 0.5F));
  folder.write("poses.txt", kAt0);
  EXPECT_THAT(refusalOf([&] { opened({folder.path()}); }), HasSubstr("has 1 lines and the scan is number 4 (from 0)"));
}

TEST(ScanSet, ReadsTheLayoutOfFreiburg) {
  const ScratchFolder folder;
  folder.write("scan_9_points.dat", "0 0 1 1 2 3\n");
  folder.write("scan_9_robotPoses.dat", "0 0 0 0 0 0\n7 0 0 0 0 0\n");
  folder.write("scan_9_labels.dat", "4\n");
  folder.write("scan_10_points.dat", "0 0 1 1 2 3\n");
  folder.write("scan_10_robotPoses.dat", "0 0 0 0 0 0\n8 0 0 0 0 0\n");
  const ScanSet set = opened({folder.path()});
  EXPECT_THAT(namesOf(set), ElementsAre("scan_9_points.dat", "scan_10_points.dat"));
  EXPECT_EQ(xOf(set, 1), 8);
  EXPECT_THAT(set.load(0).points.label, ElementsAre(4U));
  EXPECT_EQ(set.load(0).points.origin[0], Eigen::Vector3f(0, 0, 1));
  folder.write("scan_11_points.dat", "0 0 1 1 2 3\n");
  EXPECT_THAT(refusalOf([&] { opened({folder.path()}); }), HasSubstr("the pose of scan_11_points.dat is missing"));
}

TEST(ScanSet, TakesTheViewpointOfAPcdOnlyWhereNoPosesAreGiven) {
  const ScratchFolder folder;
  const std::string pcd =
      "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nVIEWPOINT 6 0 0 1 0 0 0\nPOINTS 1\nDATA "
      "ascii\n1 2 3\n";
  folder.write("a.pcd", pcd);
  EXPECT_EQ(xOf(opened({folder.path()}), 0), 6);
  EXPECT_TRUE(opened({folder.path()}).load(0).has_pose);
  folder.write("poses.txt", kAt9);
  EXPECT_EQ(xOf(opened({folder.path()}), 0), 9);
}

TEST(ScanSet, GivesPosesByHandToAllInputsInOrder) {
  const ScratchFolder folder;
  const auto a = folder.write("a/a.xyz", "1 2 3\n");
  const auto b = folder.write("b/b.xyz", "1 2 3\n");
  const auto poses = folder.write("poses.txt", kAt5 + kAt9);
  const ScanSet set = opened({b, a}, {.poses = poses});
  EXPECT_THAT(namesOf(set), ElementsAre("b.xyz", "a.xyz"));
  EXPECT_EQ(xOf(set, 0), 5);
}

TEST(ScanSet, PutsWorldCoordinatesIntoAPlaceOfTheirOwn) {
  const ScratchFolder folder;
  const auto file = folder.write("utm.xyz", "456123.125 5412345.25 230\n");
  const Scan scan = opened({file}).load(0);
  EXPECT_EQ(toMap(scan.T_map_sensor, {scan.points.x[0], scan.points.y[0], scan.points.z[0]}),
            Eigen::Vector3d(456123.125, 5412345.25, 230));
  EXPECT_FALSE(scan.has_pose);
  folder.write("poses.txt", kAt5);
  EXPECT_THAT(refusalOf([&] { opened({folder.path()}).load(0); }), HasSubstr("but the scan has a pose"));
}

TEST(ScanSet, TakesPosesAndFarPointsOfScansInMillimetres) {
  const ScratchFolder folder;
  folder.write("a.xyz", "41000 5000 100\n1500 2500 -200\n");
  folder.write("far.xyz", "4100000 0 0\n");
  folder.write("m.yaml", "scans: [{path: a.xyz, pose: {xyz: [1000, 0, 0], rpy_deg: [0, 0, 0]}}]\n");
  folder.write("far.yaml", "scans: [{path: far.xyz, pose: {xyz: [1000, 0, 0], rpy_deg: [0, 0, 0]}}]\n");
  ProgressSink silent;
  ScanSetParams params;
  params.frame.unit = LengthUnit::Millimetre;
  const Scan scan = ScanSet::open({folder.path() / "m.yaml"}, params, silent).load(0);
  EXPECT_EQ(scan.T_map_sensor.translation(), Eigen::Vector3d(1, 0, 0));
  EXPECT_NEAR(scan.points.x[0], 41, 1e-5);
  EXPECT_NEAR(scan.points.x[1], 1.5, 1e-5);
  EXPECT_NEAR(scan.points.z[1], -0.2, 1e-5);
  EXPECT_THAT(refusalOf([&] { ScanSet::open({folder.path() / "far.yaml"}, params, silent).load(0); }),
              HasSubstr("more than 4096 m from the sensor"));
}

TEST(ScanSet, RefusesWhatItCannotUnderstand) {
  const ScratchFolder folder;
  EXPECT_THAT(refusalOf([&] { opened({folder.path() / "absent"}); }), HasSubstr("there is no such file or folder"));
  EXPECT_THAT(refusalOf([&] { opened({folder.path()}); }), HasSubstr("the folder holds no scans"));
  EXPECT_THAT(refusalOf([&] { opened({folder.write("a.jpg", "x")}); }),
              HasSubstr("the format of this file is not known"));
  EXPECT_THAT(refusalOf([&] { opened({folder.write("seven.txt", "1 2 3 4 5 6 7\n")}); }),
              HasSubstr("7 columns are no known form of a scan"));
  const auto empty = folder.write("empty.xyz", "");
  EXPECT_THAT(refusalOf([&] { opened({empty}).load(0); }), HasSubstr("holds no points"));
}

TEST(ScanSet, TellsLabelledTextByItsFiveColumns) {
  const ScratchFolder folder;
  const ScanSet set = opened({folder.write("a.txt", "# c\n1 2 3 4 5\n")});
  EXPECT_EQ(set.file(0).format, ScanFormat::LabelledText);
}

TEST(ContentId, IsIndependentOfPathFormatPoseAndLabels) {
  const ScratchFolder folder;
  const auto text = folder.write("t/a.xyz", "1.5 2 3 0.5\n");
  const auto kitti = folder.write("k/b.bin", bytesOfAll(1.5F, 2.F, 3.F, 0.5F));
  const auto ply =
      folder.write("p/c.ply",
                   "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty float y\nproperty float z\n"
                   "property float intensity\nproperty int label\nend_header\n1.5 2 3 0.5 7\n");
  folder.write("p/poses.txt", kAt5);
  const ScanSet set = opened({text, kitti, ply});
  EXPECT_EQ(set.load(0).id, set.load(1).id);
  EXPECT_EQ(set.load(0).id, set.load(2).id);
}

TEST(ContentId, ChangesWithEveryThingThatWasMeasured) {
  Scan scan;
  scan.points.x = {1, 2};
  scan.points.y = {1, 2};
  scan.points.z = {1, 2};
  std::vector<ScanId> ids{contentIdOf(scan)};
  const auto changed = [&](const auto& change) {
    Scan other = scan;
    change(other);
    ids.push_back(contentIdOf(other));
  };
  changed([](Scan& s) { s.points.x[0] = 1.0000001F; });
  changed([](Scan& s) { std::swap(s.points.x[0], s.points.x[1]); });
  changed([](Scan& s) { s.points.intensity = {1, 2}; });
  changed([](Scan& s) { s.points.origin.assign(2, Eigen::Vector3f::Zero()); });
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(std::adjacent_find(ids.begin(), ids.end()), ids.end());
}

TEST(ContentId, DoesNotChangeWithTimeLabelsPoseOrPath) {
  Scan scan;
  scan.points.x = scan.points.y = scan.points.z = {1, 2};
  Scan other = scan;
  other.time_s = 5;
  other.points.label = {1, 2};
  other.T_map_sensor.translation().x() = 7;
  other.has_pose = true;
  other.source = "elsewhere.pcd";
  EXPECT_EQ(contentIdOf(other), contentIdOf(scan));
}

/// A pipe without a writer would be waited for.
TEST(ScanSet, RefusesPipesAndDevices) {
  const ScratchFolder folder;
  const auto pipe = folder.path() / "pipe.xyz";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  folder.write("manifest.yaml", "scans: [{path: pipe.xyz}]\n");
  for (const auto& input : {pipe, folder.path() / "manifest.yaml", std::filesystem::path("/dev/zero")})
    EXPECT_THAT(refusalOf([&] { opened({input}); }),
                HasSubstr("is a pipe or a device, a file or a folder was expected"));
}

TEST(ScanSummary, CountsPointsLabelsAndTheExtentInTheMap) {
  const ScratchFolder folder;
  folder.write("a.xyz_label_conf", "1 2 3 7 0\n3 4 5 7 0\n");
  folder.write("b.xyz_label_conf", "0 0 0 8 0\n");
  folder.write("poses.txt", kAt5 + kAt9);
  for (const unsigned threads : {1U, 2U}) {
    const ScanSetSummary summary = summarize(opened({folder.path()}), threads);
    EXPECT_EQ(summary.point_count, 3U);
    EXPECT_EQ(summary.points_by_label, (std::map<std::uint32_t, std::size_t>{{7, 2}, {8, 1}}));
    EXPECT_EQ(summary.extent_map_m.min(), Eigen::Vector3d(6, 0, 0));
    EXPECT_EQ(summary.extent_map_m.max(), Eigen::Vector3d(9, 4, 5));
    EXPECT_EQ(summary.scans.at(1).format, ScanFormat::LabelledText);
    EXPECT_TRUE(summary.scans.at(1).has_pose);
  }
}

}  // namespace
}  // namespace cluxel::scan
