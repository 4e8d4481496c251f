// SPDX-License-Identifier: Apache-2.0
// Tests round trips of written scans.
#include "scan/formats/scan_writer.hpp"

#include <random>

#include "scan/scan_fixture.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::scan {
namespace {

using test::refusalOf;
using test::ScratchFolder;
using testing::HasSubstr;

Scan randomScan(unsigned seed, bool with_attributes) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> metres(-50, 50);
  Scan scan;
  for (int i = 0; i < 1000; ++i) {
    scan.points.x.push_back(metres(random));
    scan.points.y.push_back(metres(random));
    scan.points.z.push_back(metres(random));
    if (!with_attributes) continue;
    scan.points.intensity.push_back(metres(random));
    scan.points.label.push_back(static_cast<std::uint32_t>(random()));
    scan.points.origin.emplace_back(metres(random), metres(random), metres(random));
  }
  scan.T_map_sensor = Eigen::Translation3d(metres(random), metres(random), 1.7) *
                      Eigen::AngleAxisd(metres(random), Eigen::Vector3d(1, 2, 3).normalized());
  scan.has_pose = true;
  scan.time_s = 1234567890.123456789 + seed;
  scan.id = contentIdOf(scan);
  return scan;
}

void expectSamePoints(const ScanPoints& a, const ScanPoints& b) {
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.z, b.z);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_EQ(a.label, b.label);
  EXPECT_EQ(a.origin, b.origin);
}

TEST(ScanWriter, WritesFoldersThatAreReadBackUnchanged) {
  for (const bool with_attributes : {false, true}) {
    const ScratchFolder folder;
    std::vector<Scan> scans;
    std::vector<Eigen::Isometry3d> poses;
    std::vector<double> times;
    for (unsigned i = 0; i < 3; ++i) {
      scans.push_back(randomScan(i, with_attributes));
      writeScanFile(scans.back(), folder.path() / ("scan_" + std::to_string(i) + ".pcd"));
      poses.push_back(scans.back().T_map_sensor);
      times.push_back(*scans.back().time_s);
    }
    writePoses(poses, folder.path() / "poses.txt");
    writeTimes(times, folder.path() / "times.txt");
    ProgressSink silent;
    const ScanSet set = ScanSet::open({folder.path()}, {}, silent);
    ASSERT_EQ(set.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      const Scan back = set.load(i);
      expectSamePoints(back.points, scans[i].points);
      EXPECT_EQ(back.T_map_sensor.matrix(), scans[i].T_map_sensor.matrix());
      EXPECT_EQ(back.id, scans[i].id);
      EXPECT_TRUE(back.has_pose);
    }
  }
}

TEST(ScanWriter, KeepsThePoseOfALoneFileInItsViewpoint) {
  const ScratchFolder folder;
  const Scan scan = randomScan(7, false);
  writeScanFile(scan, folder.path() / "a.pcd");
  ProgressSink silent;
  const Scan back = ScanSet::open({folder.path() / "a.pcd"}, {}, silent).load(0);
  EXPECT_TRUE(back.has_pose);
  EXPECT_LT((back.T_map_sensor.matrix() - scan.T_map_sensor.matrix()).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ScanWriter, WritesTheSameBytesForTheSameScan) {
  const ScratchFolder folder;
  writeScanFile(randomScan(1, true), folder.path() / "a.pcd");
  writeScanFile(randomScan(1, true), folder.path() / "b.pcd");
  const auto bytesOf = [](const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  EXPECT_EQ(bytesOf(folder.path() / "a.pcd"), bytesOf(folder.path() / "b.pcd"));
}

TEST(ScanWriter, RefusesScansThatCannotBeReadBack) {
  const ScratchFolder folder;
  EXPECT_THAT(refusalOf([&] { writeScanFile(Scan{}, folder.path() / "a.pcd"); }),
              HasSubstr("an empty scan cannot be written"));
  Scan scan = randomScan(1, false);
  scan.points.z.pop_back();
  EXPECT_THAT(refusalOf([&] { writeScanFile(scan, folder.path() / "a.pcd"); }), HasSubstr("differ in length"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.pcd"));
  EXPECT_THROW(writeScanFile(randomScan(1, false), folder.path() / "absent" / "a.pcd"), Error);
}

}  // namespace
}  // namespace cluxel::scan
