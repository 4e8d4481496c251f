// SPDX-License-Identifier: Apache-2.0
// Tests the readers on real scans; skipped where these are absent.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "scan/formats/scan_writer.hpp"
#include "scan/scan_fixture.hpp"
#include "scan/scan_set.hpp"
#include "scan/truth/truth.hpp"
#include "test_paths.hpp"

namespace cluxel::scan {
namespace {

namespace fs = std::filesystem;

#define CLUXEL_REQUIRE_DATA(variable, name)                   \
  const fs::path variable = test::outsideDataFolder() / name; \
  if (!fs::exists(variable)) GTEST_SKIP() << "outside data absent: " << (name)

ScanSet opened(const fs::path& input) {
  ProgressSink silent;
  return ScanSet::open({input}, {}, silent);
}

TEST(RealScans, OaklandHasTenChunksOfAHundredThousandLabelledPoints) {
  CLUXEL_REQUIRE_DATA(folder, "oakland3d");
  const ScanSet set = opened(folder);
  ASSERT_EQ(set.size(), 10U);
  std::size_t total = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Scan scan = set.load(i);
    total += scan.points.size();
    EXPECT_GE(scan.points.size(), 99'000U) << scan.source;
    EXPECT_EQ(scan.points.label.size(), scan.points.size());
    EXPECT_FALSE(scan.has_pose);
  }
  EXPECT_NEAR(static_cast<double>(total), 1e6, 1e4);
}

TEST(RealScans, OaklandTruthFilesFollowFromTheLabelsThroughTheLabelMap) {
  CLUXEL_REQUIRE_DATA(folder, "oakland3d");
  CLUXEL_REQUIRE_DATA(truth_folder, "oakland3d_truth");
  const LabelMap map = LabelMap::load(test::sourceFolder() / "labels" / "oakland.yaml");
  const ScanSet set = opened(folder);
  constexpr std::uint32_t kPost = 1110;
  std::size_t primitives_differ = 0, posts_differ = 0, others_differ = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Scan scan = set.load(i);
    const auto file = truthFileOf(truth_folder, set.file(i).path);
    ASSERT_TRUE(file.has_value());
    const PointTruth given = truthFromFile(*file, scan.points.size());
    const PointTruth derived = truthFromLabels(scan, map);
    for (std::size_t k = 0; k < scan.points.size(); ++k) {
      primitives_differ += given.primitive[k] != derived.primitive[k] ? 1 : 0;
      if (given.object_class[k] == derived.object_class[k]) continue;
      const bool post_of_a_tiny_sign =
          scan.points.label[k] == kPost && given.object_class[k] == 8 && derived.object_class[k] == 5;
      ++(post_of_a_tiny_sign ? posts_differ : others_differ);
    }
  }
  EXPECT_EQ(primitives_differ, 0U);
  EXPECT_EQ(others_differ, 0U);
  EXPECT_EQ(posts_differ, 111U) << "the truth files give a post to a sign only when the sign has 20 points or more";
}

TEST(RealScans, OaklandNamesInstancesThatDoNotCount) {
  CLUXEL_REQUIRE_DATA(folder, "oakland3d_truth");
  const std::vector<std::int32_t> ids = ambiguousInstances(folder);
  EXPECT_GT(ids.size(), 50U);
  EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
}

/// The median height of the road points within 10 m of a place in the map frame.
double groundHeight(const Scan& scan, const Eigen::Vector2d& place) {
  std::vector<double> heights;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3d p = toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]});
    if (scan.points.label[i] == 40 && (p.head<2>() - place).norm() < 10) heights.push_back(p.z());
  }
  if (heights.size() < 100) return NAN;
  std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2), heights.end());
  return heights[heights.size() / 2];
}

TEST(RealScans, KittiGroundLiesAtOneHeightFromScanToScan) {
  CLUXEL_REQUIRE_DATA(folder, "kitti00");
  const ScanSet set = opened(folder);
  ASSERT_EQ(set.size(), 16U);
  Scan before = set.load(0);
  EXPECT_EQ(before.points.label.size(), before.points.size());
  for (std::size_t i = 1; i < set.size(); ++i) {
    const Scan scan = set.load(i);
    const Eigen::Vector3d step = scan.T_map_sensor.translation() - before.T_map_sensor.translation();
    EXPECT_GT(step.x(), 0.5) << "the car drives forward along x";
    EXPECT_LT(std::abs(step.z()), 0.1);
    const Eigen::Vector2d place = scan.T_map_sensor.translation().head<2>();
    EXPECT_NEAR(groundHeight(scan, place), groundHeight(before, place), 0.05) << scan.source;
    before = scan;
  }
}

TEST(RealScans, SmallGicpCloudsOverlapUnderTheirTransform) {
  CLUXEL_REQUIRE_DATA(folder, "small_gicp");
  ProgressSink silent;
  const ScanSet target = opened(folder / "target.ply");
  const ScanSet source = ScanSet::open({folder / "source.ply"}, {.poses = folder / "T_target_source.txt"}, silent);
  const Scan a = target.load(0);
  const Scan b = source.load(0);
  EXPECT_EQ(b.points.size(), 69792U);
  EXPECT_EQ(b.points.intensity.size(), b.points.size());
  EXPECT_NEAR(b.T_map_sensor.translation().x(), 0.488882, 1e-6);
  EXPECT_GT(a.points.size(), 50'000U);
}

TEST(RealScans, SurviveTheWayThroughThePcdWriter) {
  CLUXEL_REQUIRE_DATA(folder, "kitti00");
  const Scan scan = opened(folder).load(3);
  const test::ScratchFolder scratch;
  writeScanFile(scan, scratch.path() / "a.pcd");
  const Scan back = opened(scratch.path()).load(0);
  EXPECT_EQ(back.id, scan.id);
  EXPECT_EQ(back.points.label, scan.points.label);
}

TEST(RealScans, SydneyHasTheObjectsOfItsTable) {
  CLUXEL_REQUIRE_DATA(folder, "sydney");
  const LabelMap map = LabelMap::load(test::sourceFolder() / "labels" / "sydney.yaml");
  std::map<std::string, std::size_t> counted, listed;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".ply") continue;
    const Scan scan = opened(entry.path()).load(0);
    const auto instances = instancesFromFile(scan, map.instanceField());
    std::map<std::int32_t, std::uint32_t> label_of;
    for (std::size_t i = 0; i < instances.size(); ++i)
      if (instances[i] >= 0) label_of.emplace(instances[i], scan.points.label[i]);
    for (const auto& [instance, label] : label_of) ++counted[map.find(label)->name];
  }
  std::ifstream table(folder / "objects.csv");
  std::string line;
  std::getline(table, line);
  ASSERT_EQ(line.substr(0, 19), "scan,instance,class");
  while (std::getline(table, line)) {
    const std::size_t first = line.find(',', line.find(',') + 1) + 1;
    ++listed[line.substr(first, line.find(',', first) - first)];
  }
  EXPECT_EQ(counted, listed);
}

}  // namespace
}  // namespace cluxel::scan
