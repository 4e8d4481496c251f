// SPDX-License-Identifier: Apache-2.0
// A map that grows while scans arrive is the map that a build from all of them gives.
#include "mapping/change/folder_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iomanip>
#include <sstream>
#include <thread>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

class Notes : public ProgressSink {
 public:
  void note(std::string_view message) override { all.emplace_back(message); }
  std::vector<std::string> all;
};

class FolderWatch : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 8, .stops = 3, .size_m = 45, .points_per_stop = 1000});
    inputs = new MapInputs(shippedInputs());
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
  }

  FolderWatch() { fs::create_directory(scans()); }
  fs::path scans() const { return folder.path() / "scans"; }
  fs::path map() const { return folder.path() / "map.clx"; }

  /// Writes the file in two steps, as a slow recorder does.
  void arrive(std::size_t number) const {
    const std::string bytes = readFile(campus->files()[number]);
    const fs::path file = scans() / campus->files()[number].filename();
    writeFile(file, bytes.substr(0, bytes.size() / 2));
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    writeFile(file, bytes);
  }

  /// Watches until `count` scans are in the map; `each` runs after each commit.
  std::size_t watch(std::size_t count, const std::function<void(std::size_t)>& each) {
    WatchCallbacks callbacks;
    std::size_t in_map = 0;
    callbacks.inputs = [] { return *inputs; };
    callbacks.committed = [&](std::size_t, std::size_t total, std::size_t) { each(in_map = total); };
    callbacks.is_stopped = [&] { return in_map >= count; };
    return watchFolder(scans(), map(), {.threads = 1, .interval_s = 0.05, .idle_s = 120}, callbacks, notes);
  }

  rdf::ScratchFolder folder;
  Notes notes;
  static inline SmallCampus* campus = nullptr;
  static inline MapInputs* inputs = nullptr;
};

TEST_F(FolderWatch, GrowsTheMapToTheOneOfAllScans) {
  arrive(0);
  std::vector<std::size_t> totals;
  const std::size_t added = watch(3, [&](std::size_t total) {
    totals.push_back(total);
    if (total < 3) arrive(total);
  });
  EXPECT_EQ(added, 3);
  EXPECT_THAT(totals, ::testing::ElementsAre(1, 2, 3));
  EXPECT_TRUE(canonicalText(map()) == builtText(campus->files(), *inputs));
}

TEST_F(FolderWatch, TakesOnlyWhatIsNewAfterARestart) {
  arrive(0);
  watch(1, [](std::size_t) {});
  arrive(1);
  std::vector<std::size_t> totals;
  EXPECT_EQ(watch(2, [&](std::size_t total) { totals.push_back(total); }), 1);
  EXPECT_THAT(totals, ::testing::ElementsAre(2));
}

/// Ends a build after its first commit.
class StopAtSecondScan : public ProgressSink {
 public:
  struct Stopped {};
  void progress(std::string_view stage, std::size_t done, std::size_t) override {
    if (stage == "scans" && done == 2) throw Stopped();
  }
};

TEST_F(FolderWatch, GoesOnWithAFirstBuildThatWasInterrupted) {
  arrive(0);
  arrive(1);
  StopAtSecondScan stop;
  EXPECT_THROW(buildMap(scansOf({scans()}), *inputs, map(), {.batch_points = 1}, stop), StopAtSecondScan::Stopped);
  ASSERT_TRUE(fs::exists(map()));
  writeFile(scans() / "broken.pcd", readFile(campus->files()[2]).substr(0, 1000));  // the recorder was killed, too
  std::vector<std::size_t> totals;
  watch(3, [&](std::size_t total) {
    totals.push_back(total);
    if (total == 2) arrive(2);
  });
  EXPECT_THAT(notes.all, ::testing::Contains(::testing::HasSubstr("broken.pcd")));
  EXPECT_THAT(totals, ::testing::ElementsAre(2, 3));
  EXPECT_TRUE(canonicalText(map()) == builtText(campus->files(), *inputs));
}

/// Writes poses of the first scans, the x of the first one shifted.
void writePoses(const fs::path& file, const std::vector<fs::path>& scans, std::size_t count, double shift_m) {
  std::ostringstream text;
  text << std::setprecision(17);
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Matrix4d pose = scansOf({scans[i]}).file(0).T_map_sensor.matrix();
    if (i == 0) pose(0, 3) += shift_m;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) text << pose(row, column) << ' ';
    text << '\n';
  }
  writeFile(file, text.str());
}

TEST_F(FolderWatch, MovesScansWhosePosesAreCorrected) {
  const fs::path poses = scans() / "poses.txt";
  writePoses(poses, campus->files(), 2, 0);
  arrive(0);
  arrive(1);
  std::vector<std::size_t> totals;
  watch(3, [&](std::size_t total) {
    totals.push_back(total);
    if (totals.size() == 1) writePoses(poses, campus->files(), 2, 0.5);
    if (totals.size() == 2) {
      writePoses(poses, campus->files(), 3, 0.5);
      arrive(2);
    }
  });
  EXPECT_THAT(totals, ::testing::ElementsAre(2, 2, 3));
  EXPECT_THAT(notes.all,
              ::testing::Contains(::testing::HasSubstr("scans moved to the poses that the folder has now: 1")));
  EXPECT_TRUE(canonicalText(map()) == builtText({scans()}, *inputs));
  // Corrected while nobody watched.
  writePoses(poses, campus->files(), 3, 0);
  WatchCallbacks callbacks;
  callbacks.inputs = [] { return *inputs; };
  watchFolder(scans(), map(), {.threads = 1, .interval_s = 0.05, .idle_s = 0.3}, callbacks, notes);
  EXPECT_TRUE(canonicalText(map()) == builtText({scans()}, *inputs));
}

TEST_F(FolderWatch, LeavesAScanWhereItIsWhenACopyOfItHasAnotherPose) {
  const fs::path poses = scans() / "poses.txt";
  std::vector<fs::path> files{campus->files()[0], campus->files()[1], campus->files()[2]};
  writePoses(poses, files, 2, 0);
  arrive(0);
  arrive(1);
  WatchCallbacks callbacks;
  callbacks.inputs = [] { return *inputs; };
  const auto look = [&] {
    return watchFolder(scans(), map(), {.threads = 1, .interval_s = 0.05, .idle_s = 0.4}, callbacks, notes);
  };
  EXPECT_EQ(look(), 2U);
  const std::string two = canonicalText(map());
  fs::copy_file(scans() / files[0].filename(), scans() / "zz_copy.pcd");
  writePoses(poses, files, 3, 0);  // the third pose is that of the copy
  for (int run = 0; run < 3; ++run) {
    EXPECT_EQ(look(), 0U);
    EXPECT_TRUE(canonicalText(map()) == two) << "run " << run;
  }
  EXPECT_THAT(notes.all, ::testing::Contains(::testing::HasSubstr("is the same scan as another file of the folder")));
  // While it watches, the copy goes, and the pose of the scan is corrected.
  bool is_moved = false;
  callbacks.committed = [&](std::size_t, std::size_t, std::size_t) { is_moved = true; };
  std::size_t looks = 0;
  callbacks.is_stopped = [&] {
    if (++looks == 6) {
      fs::remove(scans() / "zz_copy.pcd");
      writePoses(poses, files, 2, 0.5);
    }
    return is_moved;
  };
  EXPECT_EQ(watchFolder(scans(), map(), {.threads = 1, .interval_s = 0.05, .idle_s = 120}, callbacks, notes), 1U);
  EXPECT_TRUE(canonicalText(map()) == builtText({scans()}, *inputs));
}

TEST_F(FolderWatch, BeginsInAnEmptyFile) {
  writeFile(map(), "");
  arrive(0);
  EXPECT_EQ(watch(1, [](std::size_t) {}), 1);
}

TEST_F(FolderWatch, NotesAScanThatCannotBeReadAndGoesOn) {
  arrive(0);
  const std::string bytes = readFile(campus->files()[1]);
  writeFile(scans() / "broken.pcd", bytes.substr(0, bytes.size() / 2));
  watch(1, [](std::size_t) {});
  arrive(2);
  watch(2, [](std::size_t) {});
  EXPECT_THAT(notes.all, ::testing::Contains(::testing::HasSubstr("broken.pcd")));
}

TEST_F(FolderWatch, EndsWhenNothingArrives) {
  WatchCallbacks callbacks;
  callbacks.inputs = [] { return *inputs; };
  EXPECT_EQ(watchFolder(scans(), map(), {.threads = 1, .interval_s = 0.05, .idle_s = 0.2}, callbacks, notes), 0);
  EXPECT_FALSE(fs::exists(map()));
  EXPECT_THROW(watchFolder(scans() / "nowhere", map(), {}, callbacks, notes), Error);
}

}  // namespace
}  // namespace cluxel::mapping
