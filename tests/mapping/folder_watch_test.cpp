// SPDX-License-Identifier: Apache-2.0
// A map that grows while scans arrive is the map that a build from all of them gives.
#include "mapping/watch/folder_watch.hpp"

#include "mapping/watch_fixture.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

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

TEST_F(FolderWatch, TellsOfObjectsWhatExtendTells) {
  const fs::path other = folder.path() / "other.clx";
  buildMap(scansOf({campus->files()[0]}), *inputs, other, {}, silence());
  const std::size_t first_objects = MapReader(other).summary().objects;
  const ChangeReport expected = extendMap(other, scansOf({campus->files()[1]}), {}, silence());
  arrive(0);
  std::vector<WatchCommit> commits;
  WatchCallbacks callbacks;
  callbacks.inputs = [] { return *inputs; };
  callbacks.committed = [&](const WatchCommit& commit) {
    commits.push_back(commit);
    if (commits.size() == 1) arrive(1);
  };
  callbacks.is_stopped = [&] { return commits.size() == 2; };
  watchFolder(scans(), map(), {.threads = 1, .interval_s = 0.05, .idle_s = 120}, callbacks, notes);
  ASSERT_EQ(commits.size(), 2U);
  EXPECT_EQ(commits[0].objects_added, first_objects) << "all objects of a build are new";
  EXPECT_GT(commits[0].tiles_decided, 0U);
  EXPECT_FALSE(expected.objects.isEmpty());
  EXPECT_EQ(commits[1].objects_added, expected.objects.added.size());
  EXPECT_EQ(commits[1].objects_changed, expected.objects.changed.size());
  EXPECT_EQ(commits[1].objects_redecided, expected.objects.redecided.size());
  EXPECT_EQ(commits[1].objects_gone, expected.objects.gone.size());
  EXPECT_EQ(commits[1].objects_split, expected.objects.split.size());
  EXPECT_EQ(commits[1].objects_joined, expected.objects.joined.size());
  EXPECT_EQ(commits[1].tiles_decided, expected.tiles_decided);
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
  callbacks.committed = [&](const WatchCommit&) { is_moved = true; };
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
