// SPDX-License-Identifier: Apache-2.0
// Maps of generated and of measured scans grow, merge, shrink and move: in random orders and splits, and each operation
// with one thread and with two. Each is then the map that a build makes from nothing. Measured are the scans of a
// spinning laser and of a line scanner on a vehicle. The long tests do each operation in 20 random ways.
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
#include "mapping/long_tests.hpp"
#include "mapping/small_campus.hpp"
#include "tasks/box_visits.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

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
  const float range_m = isLong() ? 25 : 15;
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < std::min<std::size_t>(all.size(), isLong() ? 6 : 4); ++i)
    scans.push_back(partOf(all.load(i), [&](float x, float y) { return x * x + y * y < range_m * range_m; }));
  return scans;
}

/// Windows of a chunk, each of which overlaps the next.
std::vector<Scan> windowsOf(const Scan& chunk, std::size_t count) {
  const float stride_m = isLong() ? 12 : 6, overlap_m = 4, width_m = isLong() ? 60 : 25;
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

/// Windows of two chunks of Oakland, one after the other along the drive.
std::vector<Scan> windowsOfOakland() {
  std::vector<Scan> scans;
  for (const char* chunk : {"ac", "ad"}) {
    const fs::path file =
        test::outsideDataFolder() / ("oakland3d/oakland_part2_" + std::string(chunk) + ".xyz_label_conf");
    const std::vector<Scan> windows = windowsOf(ScanSet::open({file}, {}, silence()).load(0), isLong() ? 3 : 2);
    scans.insert(scans.end(), windows.begin(), windows.end());
  }
  return scans;
}

std::vector<Scan> stopsOfCampus() {
  const Campus campus = buildCampus({.seed = 12,
                                     .stops = isLong() ? 6.0 : 4.0,
                                     .size_m = isLong() ? 60.0 : 45.0,
                                     .points_per_stop = 2500,
                                     .max_range_m = isLong() ? 25.0 : 15.0});
  const Laser laser(campus);
  std::vector<Scan> scans;
  for (std::size_t stop = 0; stop < campus.stops.size(); ++stop) scans.push_back(laser.scanAt(stop).scan);
  return scans;
}

/// A car between two walls that is there, gone, and there again, a day from one visit to the next.
std::vector<Scan> visitsOfACar() {
  const std::vector<tasks::Box> walls{tasks::boxFrom({-15, 10, 0}, {15, 10.5, 5}),
                                      tasks::boxFrom({-15, -12.5, 0}, {15, -12, 5})};
  std::vector<tasks::Box> all = walls;
  all.push_back(tasks::boxFrom({2, 4, 0.05}, {6.2, 5.8, 1.5}));
  std::vector<Scan> scans;
  for (const std::vector<tasks::Box>& boxes : {all, walls, all})
    for (const Eigen::Vector3d& sensor : {Eigen::Vector3d(1, -1, 1.8), Eigen::Vector3d(6, 1, 1.8)}) {
      const auto number = static_cast<unsigned>(scans.size());
      scans.push_back(
          partOf(tasks::scanOf({boxes, {}}, sensor, number), [](float x, float y) { return std::hypot(x, y) < 15; }));
      scans.back().time_s = 1.7e9 + 86400.0 * (number / 2) + 10 * number;
    }
  return scans;
}

struct Sensor {
  const char* name = nullptr;
  bool is_outside = true;  ///< in a folder of the name among the data from outside
  std::vector<Scan> (*scans)() = nullptr;
  bool has_times = false;
};

class MeasuredChanges : public testing::TestWithParam<Sensor> {
 protected:
  using Poses = std::map<std::size_t, int>;  ///< scan → number of its pose: 0 the given one, 1 a moved one

  void SetUp() override {
    if (GetParam().is_outside && !fs::exists(test::outsideDataFolder() / GetParam().name))
      GTEST_SKIP() << "outside data absent: " << GetParam().name;
    const fs::path given = folder_.path() / "scans";
    fs::create_directory(given);
    std::vector<double> times_s;
    for (const Scan& scan : GetParam().scans()) {
      ASSERT_GT(scan.points.size(), 2000U);
      writeScanFile(scan, given / ("scan" + std::to_string(times_s.size()) + ".pcd"));
      times_s.push_back(scan.time_s.value_or(0));
    }
    if (GetParam().has_times) writeTimes(times_s, given / "times.txt");
    scans_ = std::make_unique<ScanSet>(scansOf({given}));
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
  const std::string& fromScratch(const Poses& poses) {
    const auto [entry, is_new] = built_.try_emplace(poses);
    if (is_new) entry->second = canonicalText(build(at(poses), "fresh.clx"));
    return entry->second;
  }
  std::vector<std::size_t> shuffled() {
    std::vector<std::size_t> order(scans_->size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), random_);
    return order;
  }
  std::size_t below(std::size_t end) { return static_cast<std::size_t>(random_() % end); }
  static int rounds() { return isLong() ? 20 : 1; }
  /// Numbers of threads to compute with; long tests compare them.
  std::vector<unsigned> threadCounts() {
    if (isLong()) return {1, 2};
    return {1 + static_cast<unsigned>(below(2))};
  }

  /// The window may be as large as the map.
  static ChangeParams paramsOf(unsigned threads) { return {.threads = threads, .max_window_share = 2}; }

  /// Lets `operation` change `map`, with each number of threads what the map was before.
  template <typename Operation>
  void expectChanged(const fs::path& map, const std::string& expected, const Operation& operation) {
    const fs::path before = folder_.path() / "before.clx";
    fs::copy_file(map, before, fs::copy_options::overwrite_existing);
    for (const unsigned threads : threadCounts()) {
      fs::copy_file(before, map, fs::copy_options::overwrite_existing);
      local_commits_ += operation(paramsOf(threads)).local_commits;
      EXPECT_TRUE(canonicalText(map) == expected) << threads << " threads";
    }
  }

  ScratchFolder folder_;
  MapInputs inputs_ = shippedInputs();
  std::unique_ptr<ScanSet> scans_;
  std::vector<ScanId> ids_;
  Poses all_;
  std::string expected_;
  std::map<Poses, std::string> built_;
  std::mt19937 random_{11};
  std::size_t local_commits_ = 0;  ///< of changes that were computed around what changed
};

TEST_P(MeasuredChanges, AnyOrderAndOneByOne) {
  for (int round = 0; round < rounds(); ++round) {
    const ScanSet scans = scans_->only(shuffled());
    for (const unsigned threads : threadCounts())
      EXPECT_TRUE(canonicalText(build(scans, "map.clx", {.threads = threads, .batch_points = 1})) == expected_);
    const std::vector<std::size_t> order = shuffled();
    for (const unsigned threads : threadCounts()) {
      const fs::path map = build(scans_->only({order.front()}), "grown.clx");
      for (std::size_t i = 1; i < order.size(); ++i)
        local_commits_ += extendMap(map, scans_->only({order[i]}), paramsOf(threads), silence()).local_commits;
      EXPECT_TRUE(canonicalText(map) == expected_) << threads << " threads";
    }
  }
  EXPECT_GT(local_commits_, 0U) << "no change was computed around what changed";
}

/// Into two, three and four maps.
TEST_P(MeasuredChanges, MergesOfAnySplitInAnyOrder) {
  for (int round = 0; round < (isLong() ? rounds() : 2); ++round) {
    const std::vector<std::size_t> order = shuffled();
    const std::size_t parts = 2 + static_cast<std::size_t>(2 * round % 3);
    std::vector<std::vector<std::size_t>> split(parts);
    for (std::size_t i = 0; i < order.size(); ++i) split[i < parts ? i : below(parts)].push_back(order[i]);
    std::vector<MapToMerge> maps;
    for (std::size_t i = 0; i < parts; ++i)
      maps.push_back({build(scans_->only(split[i]), "part" + std::to_string(i) + ".clx")});
    std::shuffle(maps.begin(), maps.end(), random_);
    for (const unsigned threads : threadCounts()) {
      MergeParams merge;
      merge.change = paramsOf(threads);
      merge.force = true;
      mergeMaps(maps, folder_.path() / "merged.clx", merge, silence());
      EXPECT_TRUE(canonicalText(folder_.path() / "merged.clx") == expected_)
          << parts << " maps, " << threads << " threads";
    }
  }
}

TEST_P(MeasuredChanges, RetractedAndExtendedAgain) {
  const fs::path map = build(*scans_, "map.clx");
  for (int round = 0; round < rounds(); ++round) {
    const std::size_t scan = below(scans_->size());
    Poses without = all_;
    without.erase(scan);
    expectChanged(map, fromScratch(without),
                  [&](const ChangeParams& params) { return retractScans(map, {ids_[scan]}, params, silence()); });
    expectChanged(map, expected_,
                  [&](const ChangeParams& params) { return extendMap(map, scans_->only({scan}), params, silence()); });
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
    const auto expectMoved = [&](const std::vector<ScanPose>& moves, const auto& expected) {
      expectChanged(map, expected, [&](const ChangeParams& params) {
        const ChangeReport report = moveScans(map, moves, params, silence());
        EXPECT_EQ(report.scans_moved, moves.size());
        return report;
      });
    };
    expectMoved(moved, fromScratch(poses));
    expectMoved(back, expected_);
  }
  EXPECT_GT(local_commits_, 0U) << "no change was computed around what changed";
}

INSTANTIATE_TEST_SUITE_P(Sensors, MeasuredChanges,
                         testing::Values(Sensor{"campus", false, stopsOfCampus},
                                         Sensor{"visits", false, visitsOfACar, true},
                                         Sensor{"kitti00", true, framesOfKitti},
                                         Sensor{"oakland3d", true, windowsOfOakland}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace cluxel::mapping
