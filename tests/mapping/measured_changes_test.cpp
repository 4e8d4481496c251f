// SPDX-License-Identifier: Apache-2.0
// Maps of measured scans grow, merge, shrink and move, with one thread and with two. Each is then the map that a build
// makes from nothing. The scans are those of a spinning laser and of a line scanner on a vehicle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <random>

#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

bool isLong() {
  return std::getenv("CLUXEL_LONG_TESTS") != nullptr;
}

/// The points of a scan for which `keeps(x, y)` holds, in the sensor's frame.
template <typename Keeps>
Scan partOf(const Scan& scan, const Keeps& keeps) {
  Scan part;
  part.time_s = scan.time_s, part.T_map_sensor = scan.T_map_sensor, part.has_pose = true;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (!keeps(scan.points.x[i], scan.points.y[i])) continue;
    part.points.x.push_back(scan.points.x[i]), part.points.y.push_back(scan.points.y[i]);
    part.points.z.push_back(scan.points.z[i]);
    if (!scan.points.intensity.empty()) part.points.intensity.push_back(scan.points.intensity[i]);
  }
  return part;
}

/// Frames of KITTI, cut at some metres from the sensor.
std::vector<Scan> framesOfKitti() {
  const ScanSet all = ScanSet::open({test::outsideDataFolder() / "kitti00"}, {}, silence());
  const float range_m = isLong() ? 40 : 15;
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < std::min<std::size_t>(all.size(), isLong() ? 8 : 4); ++i)
    scans.push_back(partOf(all.load(i), [&](float x, float y) { return x * x + y * y < range_m * range_m; }));
  return scans;
}

/// Windows of a chunk of Oakland, each of which overlaps the next.
std::vector<Scan> windowsOfOakland() {
  const Scan chunk =
      ScanSet::open({test::outsideDataFolder() / "oakland3d/oakland_part2_ac.xyz_label_conf"}, {}, silence()).load(0);
  const std::size_t count = isLong() ? 6 : 4;
  const float stride_m = isLong() ? 12 : 6, overlap_m = 4, width_m = isLong() ? 200 : 25;
  std::vector<float> x = chunk.points.x, y = chunk.points.y;
  std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
  std::nth_element(y.begin(), y.begin() + static_cast<std::ptrdiff_t>(y.size() / 2), y.end());
  const float middle_x = x[x.size() / 2], middle_y = y[y.size() / 2];
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < count; ++i) {
    const float first = middle_x + (static_cast<float>(i) - static_cast<float>(count) / 2) * stride_m;
    Scan& window = scans.emplace_back(partOf(chunk, [&](float at_x, float at_y) {
      return at_x >= first && at_x < first + stride_m + overlap_m && std::abs(at_y - middle_y) < width_m / 2;
    }));
    window.T_map_sensor.translation() << middle_x, middle_y, 0;  // points that two windows share stay the same
    for (float& at_x : window.points.x) at_x -= middle_x;
    for (float& at_y : window.points.y) at_y -= middle_y;
  }
  return scans;
}

struct Sensor {
  const char* data = nullptr;
  std::vector<Scan> (*scans)() = nullptr;
};

class MeasuredChanges : public testing::TestWithParam<Sensor> {
 protected:
  using Poses = std::map<std::size_t, int>;  ///< scan → number of its pose: 0 the given one, 1 a moved one

  void SetUp() override {
    if (!fs::exists(test::outsideDataFolder() / GetParam().data))
      GTEST_SKIP() << "outside data absent: " << GetParam().data;
    std::vector<fs::path> files;
    for (const Scan& scan : GetParam().scans()) {
      ASSERT_GT(scan.points.size(), 2000U);
      files.push_back(folder_.path() / ("scan" + std::to_string(files.size()) + ".pcd"));
      writeScanFile(scan, files.back());
    }
    scans_ = std::make_unique<ScanSet>(scansOf(files));
    for (std::size_t i = 0; i < scans_->size(); ++i) ids_.push_back(scans_->load(i).id), all_[i] = 0;
    expected_ = fromScratch(all_);
  }

  Eigen::Isometry3d poseOf(std::size_t scan, int number) const {
    Eigen::Isometry3d T = scans_->file(scan).T_map_sensor;
    if (number == 0) return T;
    T.rotate(Eigen::AngleAxisd(2 * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
    return T.pretranslate(Eigen::Vector3d(0.4, -0.3, 0));
  }
  ScanSet at(const Poses& poses) const {
    std::vector<PosedScan> chosen;
    for (const auto& [scan, number] : poses) chosen.push_back({scan, poseOf(scan, number)});
    return scans_->posed(chosen);
  }
  fs::path build(const ScanSet& scans, const std::string& name, const BuildParams& params = {}) const {
    fs::remove(folder_.path() / name);
    buildMap(scans, inputs_, folder_.path() / name, params, silence());
    return folder_.path() / name;
  }
  std::string fromScratch(const Poses& poses) const { return canonicalText(build(at(poses), "fresh.clx")); }
  std::vector<std::size_t> shuffled() {
    std::vector<std::size_t> order(scans_->size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), random_);
    return order;
  }
  std::size_t below(std::size_t end) { return static_cast<std::size_t>(random_() % end); }
  /// One and two threads in turn; the window may be as large as the map.
  ChangeParams params() { return {.threads = 1 + (++operations_ % 2), .max_window_share = 2}; }
  void count(const ChangeReport& report) { local_commits_ += report.local_commits; }
  static int rounds() { return isLong() ? 6 : 1; }

  ScratchFolder folder_;
  MapInputs inputs_ = shippedInputs();
  std::unique_ptr<ScanSet> scans_;
  std::vector<ScanId> ids_;
  Poses all_;
  std::string expected_;
  std::mt19937 random_{11};
  unsigned operations_ = 0;
  std::size_t local_commits_ = 0;  ///< of changes that were computed around what changed
};

TEST_P(MeasuredChanges, AnyOrderAndOneByOne) {
  for (int round = 0; round < rounds(); ++round) {
    const ScanSet scans = scans_->only(shuffled());
    EXPECT_TRUE(canonicalText(build(scans, "map.clx", {.threads = 2, .batch_points = 1})) == expected_);
    const std::vector<std::size_t> order = shuffled();
    const fs::path map = build(scans_->only({order.front()}), "grown.clx");
    for (std::size_t i = 1; i < order.size(); ++i) count(extendMap(map, scans_->only({order[i]}), params(), silence()));
    EXPECT_TRUE(canonicalText(map) == expected_);
  }
  EXPECT_GT(local_commits_, 0U) << "no change was computed around what changed";
}

TEST_P(MeasuredChanges, MergesOfAnySplitInAnyOrder) {
  for (int round = 0; round < 2 * rounds(); ++round) {
    const std::vector<std::size_t> order = shuffled();
    const std::size_t parts = 2 + below(std::min<std::size_t>(3, order.size() - 1));
    std::vector<std::vector<std::size_t>> split(parts);
    for (std::size_t i = 0; i < order.size(); ++i) split[i < parts ? i : below(parts)].push_back(order[i]);
    std::vector<MapToMerge> maps;
    for (std::size_t i = 0; i < parts; ++i)
      maps.push_back({build(scans_->only(split[i]), "part" + std::to_string(i) + ".clx")});
    fs::remove(folder_.path() / "merged.clx");
    MergeParams merge;
    merge.change = params();
    mergeMaps(maps, folder_.path() / "merged.clx", merge, silence());
    EXPECT_TRUE(canonicalText(folder_.path() / "merged.clx") == expected_) << parts << " maps";
  }
}

TEST_P(MeasuredChanges, RetractedAndExtendedAgain) {
  const fs::path map = build(*scans_, "map.clx");
  for (int round = 0; round < rounds(); ++round) {
    const std::size_t scan = below(scans_->size());
    Poses without = all_;
    without.erase(scan);
    count(retractScans(map, {ids_[scan]}, params(), silence()));
    EXPECT_TRUE(canonicalText(map) == fromScratch(without));
    count(extendMap(map, scans_->only({scan}), params(), silence()));
    EXPECT_TRUE(canonicalText(map) == expected_);
  }
  EXPECT_GT(local_commits_, 0U) << "no change was computed around what changed";
}

/// As after a loop closure.
TEST_P(MeasuredChanges, HalfOfThePosesMovedAndCorrected) {
  const fs::path map = build(*scans_, "map.clx");
  for (int round = 0; round < rounds(); ++round) {
    const std::vector<std::size_t> order = shuffled();
    Poses poses = all_;
    std::vector<ScanPose> moved, back;
    for (std::size_t i = 0; i < order.size() / 2; ++i) {
      poses[order[i]] = 1;
      moved.push_back({ids_[order[i]], poseOf(order[i], 1)});
      back.push_back({ids_[order[i]], poseOf(order[i], 0)});
    }
    EXPECT_EQ(moveScans(map, moved, params(), silence()).scans_moved, moved.size());
    EXPECT_TRUE(canonicalText(map) == fromScratch(poses));
    count(moveScans(map, back, params(), silence()));
    EXPECT_TRUE(canonicalText(map) == expected_);
  }
  EXPECT_GT(local_commits_, 0U) << "no change was computed around what changed";
}

INSTANTIATE_TEST_SUITE_P(Sensors, MeasuredChanges,
                         testing::Values(Sensor{"kitti00", framesOfKitti}, Sensor{"oakland3d", windowsOfOakland}),
                         [](const auto& info) { return std::string(info.param.data); });

}  // namespace
}  // namespace cluxel::mapping
