// SPDX-License-Identifier: Apache-2.0
// Tests of manifests and of common faults in them.
#include "scan/formats/manifest.hpp"

#include "scan/scan_fixture.hpp"

namespace cluxel::scan {
namespace {

using test::refusalOf;
using test::ScratchFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Manifest parsed(const std::string& text) {
  return parseManifest(text, "m.yaml", "/data");
}

TEST(Manifest, ReadsEveryFormOfAPose) {
  const Manifest manifest = parsed(
      "map_origin: [456000, 5412000, 0]\ncrs: EPSG:25832\nscans:\n"
      "  - a.pcd\n"
      "  - {path: b.pcd, time_s: 12.5, pose: {xyz: [1, 2, 3], rpy_deg: [0, 0, 90]}}\n"
      "  - {path: /c.txt, format: xyz, labels: c.label, pose: {xyz: [1, 2, 3], quaternion_xyzw: [0, 0, "
      "0.70710678118, 0.70710678118]}}\n"
      "  - path: d.pcd\n    pose: [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]\n"
      "  - path: e.pcd\n    pose: {matrix: [0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1]}\n");
  ASSERT_EQ(manifest.scans.size(), 5U);
  EXPECT_EQ(manifest.map_origin, Eigen::Vector3d(456000, 5412000, 0));
  EXPECT_EQ(manifest.crs, "EPSG:25832");
  EXPECT_EQ(manifest.scans[0].path.path, "/data/a.pcd");
  EXPECT_FALSE(manifest.scans[0].pose.has_value());
  EXPECT_EQ(manifest.scans[1].time_s, 12.5);
  EXPECT_EQ(manifest.scans[2].path.path, "/c.txt");
  EXPECT_EQ(manifest.scans[2].labels->path, "/data/c.label");
  EXPECT_EQ(manifest.scans[2].format, ScanFormat::Xyz);
  for (std::size_t i = 2; i < 5; ++i) EXPECT_TRUE(manifest.scans[i].pose->isApprox(*manifest.scans[1].pose, 1e-9)) << i;
}

TEST(Manifest, ReportsAllFaultsAtOnceWithPlaceAndSuggestion) {
  const std::string text = refusalOf([] {
    parsed(
        "crss: EPSG:25832\nscans:\n  - {path: a.pcd, time: 3, pose: {xyz: [1, 2]}}\n  - {pose: {xyz: [1, 2, "
        "3]}, format: pdc}\n");
  });
  EXPECT_THAT(text, AllOf(HasSubstr("m.yaml:1:1: error: unknown key 'crss'"), HasSubstr("did you mean 'crs'?")));
  EXPECT_THAT(text,
              AllOf(HasSubstr("m.yaml:3:19: error: unknown key 'time'"), HasSubstr("xyz must be a list of 3 numbers")));
  EXPECT_THAT(text, AllOf(HasSubstr("a scan needs a 'path'"), HasSubstr("unknown format 'pdc'"),
                          HasSubstr("did you mean 'pcd'?")));
  EXPECT_THAT(text, HasSubstr("5 errors, 0 warnings"));
}

TEST(Manifest, RefusesDuplicateKeysAndAliases) {
  EXPECT_THAT(refusalOf([] { parsed("crs: a\nscans: [a.pcd]\ncrs: b\n"); }),
              HasSubstr("m.yaml:3:1: error: the key 'crs' stands here twice"));
  EXPECT_THAT(refusalOf([] { parsed("crs: &x a\nscans: [*x]\n"); }),
              HasSubstr("anchors and aliases are not supported"));
  EXPECT_THAT(refusalOf([] { parsed("scans: &a [*a]\n"); }), HasSubstr("anchors and aliases are not supported"));
}

TEST(Manifest, RefusesWhatIsNoManifest) {
  EXPECT_THAT(refusalOf([] { parsed(""); }), HasSubstr("a mapping (key: value) was expected"));
  EXPECT_THAT(refusalOf([] { parsed("[1, 2"); }), HasSubstr("this is no YAML"));
  EXPECT_THAT(refusalOf([] { parsed("scans: []\n"); }), HasSubstr("needs 'scans', a list that is not empty"));
  EXPECT_THAT(refusalOf([] { parsed("poses: p.txt\nscans: [{path: a, pose: {xyz: [0, 0, 0]}}]\n"); }),
              HasSubstr("names a file for all scans"));
  EXPECT_THAT(refusalOf([] { parsed("scans: [{path: a, pose: {xyz: [0, 0, .nan]}}]\n"); }),
              HasSubstr("xyz must be a finite number"));
  EXPECT_THAT(refusalOf([] { parsed("scans: [{path: a, pose: {xyz: [0, 0, 0], quaternion_xyzw: [1, 1, 0, 0]}}]\n"); }),
              HasSubstr("does not have length 1"));
  EXPECT_THAT(refusalOf([] { parsed("frame: world\nscans: [a]\n"); }), HasSubstr("frame must be 'map' or 'outer'"));
}

TEST(Manifest, MixesFilesFoldersPosesAndFrames) {
  const ScratchFolder folder;
  folder.write("near/a.xyz", "1 2 3\n");
  folder.write("near/poses.txt", "1 0 0 105 0 1 0 0 0 0 1 0\n");
  folder.write("b.xyz", "7 7 7\n");
  const auto manifest = folder.write(
      "site.yaml", "map_origin: [100, 0, 0]\nframe: outer\ncrs: EPSG:25832\nscans: [near, {path: b.xyz, time_s: 4}]\n");
  ProgressSink silent;
  const ScanSet set = ScanSet::open({manifest}, {}, silent);
  ASSERT_EQ(set.size(), 2U);
  EXPECT_EQ(set.file(0).T_map_sensor.translation(), Eigen::Vector3d(5, 0, 0));
  EXPECT_EQ(set.file(1).T_map_sensor.translation(), Eigen::Vector3d(-100, 0, 0));
  EXPECT_FALSE(set.file(1).has_pose);
  EXPECT_EQ(set.load(1).time_s, 4);
  EXPECT_EQ(set.mapOrigin(), Eigen::Vector3d(100, 0, 0));
  EXPECT_EQ(set.crs(), "EPSG:25832");
}

/// What is noted when a manifest with this coordinate system is read.
std::string notesOnCrs(const std::string& crs, const ScanSetParams& params = {}, const std::string& kept = "",
                       const std::string& frame = "outer") {
  const ScratchFolder folder;
  folder.write("a.xyz", "1 2 3\n");
  folder.write("poses.txt", "1 0 0 1 0 1 0 0 0 0 1 0\n");
  test::NoteKeeper sink;
  const auto manifest =
      folder.write("m.yaml", "map_origin: [0, 0, 0]\nframe: " + frame + "\ncrs: \"" + crs + "\"\nscans: [.]\n");
  EXPECT_EQ(ScanSet::open({manifest}, params, sink).crs(), kept.empty() ? crs : kept == "none" ? "" : kept);
  std::string notes;
  for (const std::string& note : sink.notes) notes += note + '\n';
  return notes;
}

TEST(Manifest, WarnsOfACoordinateSystemThatIsNoneOfMetres) {
  for (const char* crs : {"EPSG:25832", "http://www.opengis.net/def/crs/EPSG/0/25832", "+proj=utm +zone=32"})
    EXPECT_EQ(notesOnCrs(crs), "") << crs;
  EXPECT_THAT(notesOnCrs("EPSG:4326"),
              HasSubstr("m.yaml: warning: its coordinates are degrees (EPSG:4326); a map needs metres: project"));
  EXPECT_THAT(notesOnCrs("EPSG:2263"),
              HasSubstr("m.yaml: warning: the unit of its coordinate system is us-ft, but its coordinates are read as "
                        "m; state the unit"));
  for (const char* crs : {"nonsense", "EPSG:99999", "EPSG:4978"})
    EXPECT_THAT(notesOnCrs(crs), HasSubstr("m.yaml: warning: its coordinate system (" + std::string(crs) +
                                           ") is not known as one of plane coordinates"));
}

TEST(Manifest, MayHaveScansOfAnyUnitInAFrameOfTheirOwn) {
  ScanSetParams params;
  params.frame.unit = LengthUnit::Millimetre;
  EXPECT_EQ(notesOnCrs("EPSG:25832", params, "", "map"), "");
  EXPECT_THAT(notesOnCrs("EPSG:25832", params), HasSubstr("is m, but its coordinates are read as mm"));
}

TEST(Manifest, KeepsNoCoordinateSystemFromWhoseUnitTheCoordinatesAreConverted) {
  ScanSetParams params;
  params.frame.unit = LengthUnit::UsSurveyFoot;
  EXPECT_THAT(notesOnCrs("EPSG:2263", params, "none"),
              AllOf(HasSubstr("m.yaml: its coordinate system (EPSG:2263) is not kept, because the coordinates are"),
                    Not(HasSubstr("warning"))));
  EXPECT_THAT(notesOnCrs("EPSG:25832", params), HasSubstr("is m, but its coordinates are read as us-ft"));
}

TEST(Manifest, BringsEveryPoseFromTheOuterFrameIntoThatOfTheMap) {
  const ScratchFolder folder;
  folder.write("seen.pcd",
               "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
               "VIEWPOINT 105 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n1 2 3\n");
  folder.write("b.xyz", "1 2 3\n");
  const auto track = folder.write("track.txt", "1 0 0 107 0 1 0 0 0 0 1 0\n");
  const std::string frame = "map_origin: [100, 0, 0]\nframe: outer\n";
  const auto seen = folder.write("seen.yaml", frame + "scans: [seen.pcd]\n");
  const auto posed = folder.write("posed.yaml", frame + "scans: [b.xyz]\n");
  const auto both =
      folder.write("both.yaml", frame + "scans: [{path: b.xyz, pose: {xyz: [103, 0, 0], rpy_deg: [0, 0, 0]}}]\n");
  ProgressSink silent;
  EXPECT_EQ(ScanSet::open({seen}, {}, silent).file(0).T_map_sensor.translation(), Eigen::Vector3d(5, 0, 0));
  EXPECT_EQ(ScanSet::open({posed}, {track}, silent).file(0).T_map_sensor.translation(), Eigen::Vector3d(7, 0, 0));
  EXPECT_EQ(ScanSet::open({both}, {}, silent).file(0).T_map_sensor.translation(), Eigen::Vector3d(3, 0, 0));
}

TEST(Manifest, OfAFolderSpeaksForTheFolder) {
  const ScratchFolder folder;
  folder.write("a.xyz", "1 2 3\n");
  folder.write("b.xyz", "1 2 3\n");
  folder.write("track.txt", "1 0 0 3 0 1 0 0 0 0 1 0\n");
  folder.write("manifest.yaml", "poses: track.txt\nscans: [b.xyz]\n");
  ProgressSink silent;
  const ScanSet set = ScanSet::open({folder.path()}, {}, silent);
  ASSERT_EQ(set.size(), 1U);
  EXPECT_EQ(set.file(0).T_map_sensor.translation().x(), 3);
}

TEST(Manifest, ReportsWhatIsNotThereAtItsPlaceAndWithAllOtherFaults) {
  const ScratchFolder folder;
  folder.write("inner/a.xyz", "1 2 3\n");
  folder.write("b.yaml", "scans: [inner/a.xyz]\n");
  const auto manifest = folder.write("m.yaml",
                                     "poses: gone.tum\nscans:\n  - gone.pcd\n  - {path: gone_too.pcd}\n"
                                     "  - {path: inner/a.xyz, labels: gone.label}\n  - {path: inner, time_s: 3}\n"
                                     "  - b.yaml\n  - {path: inner/a.xyz, tme_s: 3}\n");
  ProgressSink silent;
  const std::string text = refusalOf([&] { ScanSet::open({manifest}, {}, silent); });
  const auto hasFault = [&](const std::string& place, const std::string& what) {
    EXPECT_THAT(text, HasSubstr("m.yaml:" + place + ": error: " + what));
  };
  const std::string inside = folder.path().string() + "/";
  hasFault("1:8", inside + "gone.tum: there is no such file or folder\n  poses: gone.tum\n         ^");
  hasFault("3:5", inside + "gone.pcd: there is no such file or folder");
  hasFault("4:12", inside + "gone_too.pcd: there is no such file or folder");
  hasFault("5:33", inside + "gone.label: there is no such file or folder");
  hasFault("6:12", inside + "inner is a folder: only a file takes pose, time_s, labels or format");
  hasFault("7:5", "a manifest cannot list the manifest " + inside + "b.yaml");
  hasFault("8:25", "unknown key 'tme_s'");
  EXPECT_THAT(text, HasSubstr("7 errors, 0 warnings"));
}

}  // namespace
}  // namespace cluxel::scan
