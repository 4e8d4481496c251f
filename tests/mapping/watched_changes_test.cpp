// SPDX-License-Identifier: Apache-2.0
// Files of a watched folder that change: the map stays the one that a build from the folder gives.
#include <fstream>

#include "mapping/build/build_lock.hpp"
#include "mapping/watch_fixture.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

class WatchedChanges : public FolderWatch {
 protected:
  fs::path fileOf(std::size_t number) const { return scans() / campus->files()[number].filename(); }

  /// One action after each commit, until all are done and one more commit has followed.
  std::size_t watchThrough(const std::vector<std::function<void()>>& actions) {
    std::size_t next = 0, seen = commits;
    return watchUntil([&] {
      if (commits == seen) return false;
      seen = commits;
      if (next == actions.size()) return true;
      actions[next++]();
      return false;
    });
  }

  /// The points of a generated scan in the map frame, in a file that has no pose.
  void writeUnposed(std::size_t number) const {
    const Scan& scan = campus->scans()[number].scan;
    std::ofstream text(scans() / ("scan" + std::to_string(number) + ".xyz"));
    for (std::size_t i = 0; i < scan.points.size(); ++i)
      text << toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]}).transpose() << '\n';
  }
};

/// Another measurement of the same size.
std::string changed(std::string bytes) {
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  return bytes;
}

TEST_F(WatchedChanges, RetractAScanWhoseFileHoldsAnotherOfTheSameSizeAndTime) {
  arrive(0);
  arrive(1);
  const std::string bytes = readFile(campus->files()[0]);
  const ScanId before = scansOf({fileOf(0)}).load(0).id;
  bool is_replaced = false;
  const std::size_t count = watchUntil([&] {
    if (scans_in_map == 2 && !std::exchange(is_replaced, true)) {
      const fs::file_time_type time = fs::last_write_time(fileOf(0));
      writeFile(fileOf(0), changed(bytes));
      fs::last_write_time(fileOf(0), time);
    }
    return notes.has("scans retracted, because their files hold other scans now: 1");
  });
  ASSERT_NE(scansOf({fileOf(0)}).load(0).id, before);
  EXPECT_EQ(count, 4U);  // three were added
  EXPECT_TRUE(canonicalText(map()) == builtOfFolder());
}

TEST_F(WatchedChanges, KeepAScanThatAnotherFileHolds) {
  arrive(0);
  fs::copy_file(fileOf(0), scans() / "copy.pcd");
  watchThrough({[&] { writeFile(fileOf(0), readFile(campus->files()[1])); }});
  EXPECT_EQ(scans_in_map, 2U);
  EXPECT_FALSE(notes.has("retracted"));
  EXPECT_TRUE(canonicalText(map()) == builtOfFolder());
  watchUntil([&, is_first = true]() mutable {
    if (commits == 2 && notes.all.size() > 0 && std::exchange(is_first, false)) fs::remove(scans() / "copy.pcd");
    return notes.has("copy.pcd: no longer");
  });
}

TEST_F(WatchedChanges, TellThatScansWereRemovedOrReplaced) {
  for (std::size_t i = 0; i < 3; ++i) arrive(i);
  watchUntil([&] {
    if (scans_in_map == 3) fs::remove(fileOf(2));
    return notes.has("stop2.pcd: no longer among the scans of the folder");
  });
  // While nobody watches.
  fs::remove(fileOf(1));
  const ScanId before = scansOf({fileOf(0)}).load(0).id;
  writeFile(fileOf(0), changed(readFile(campus->files()[0])));
  notes.all.clear();
  EXPECT_EQ(watchUntilIdle(), 1U);
  EXPECT_TRUE(notes.has("stop0.pcd: the map has another scan from a file of this name, cloud " + before.hex()));
  EXPECT_TRUE(notes.has("stop1.pcd and 1 others: no longer among the scans of the folder"));
  EXPECT_EQ(notes.count("no longer"), 1U);
}

TEST_F(WatchedChanges, IncludeScansWhosePathsAreSpeltOtherwise) {
  fs::create_directory(folder.path() / "elsewhere");
  fs::copy_file(campus->files()[1], folder.path() / "elsewhere" / "a.pcd");
  fs::create_directory_symlink(folder.path() / "elsewhere", scans() / "link");
  fs::copy_file(campus->files()[2], folder.path() / "b.pcd");
  arrive(0);
  writeFile(scans() / "manifest.yaml",
            "scans:\n  - path: ./" + fileOf(0).filename().string() + "\n  - path: link\n  - path: ../b.pcd\n");
  bool is_respelt = false;
  watchUntil([&] {
    if (scans_in_map == 3 && !std::exchange(is_respelt, true)) {
      writeFile(scans() / "manifest.yaml", "scans:\n  - path: .\n  - path: link/a.pcd\n  - path: ./../b.pcd\n");
      writeFile(fileOf(0), changed(readFile(campus->files()[0])));
    }
    return notes.has("scans retracted");
  });
  EXPECT_TRUE(canonicalText(map()) == builtOfFolder());
}

TEST_F(WatchedChanges, KeepAScanWhosePathIsSpeltOtherwiseUntilTheMapHasAnother) {
  arrive(0);
  arrive(1);
  bool is_respelt = false;
  int looks_after = 0;
  watchUntil([&] {
    if (scans_in_map == 2 && !std::exchange(is_respelt, true)) {
      const std::string path = "  - path: ./";
      writeFile(scans() / "manifest.yaml",
                "scans:\n" + path + fileOf(0).filename().string() + "\n" + path + fileOf(1).filename().string() + "\n");
      writeFile(fileOf(0), readFile(campus->files()[0]).substr(0, 2000));
    }
    return notes.has("stop0.pcd") && ++looks_after > 5;
  });
  EXPECT_FALSE(notes.has("retracted"));
  EXPECT_EQ(scans_in_map, 2U);
}

TEST_F(WatchedChanges, TakeTimesThatComeLaterAndAreCorrected) {
  arrive(0);
  arrive(1);
  const fs::path times = scans() / "times.txt";
  watchThrough(
      {[&] { writeFile(times, "1700000000\n1700000100\n"); }, [&] { writeFile(times, "1600000000\n1700000200\n"); }});
  EXPECT_TRUE(notes.has("1 known scans have earlier times now, which are taken"));
  EXPECT_TRUE(canonicalText(map()) == builtOfFolder());
  // While nobody watches.
  writeFile(times, "1500000000\n1700000200\n");
  EXPECT_EQ(watchUntilIdle(), 1U);
  EXPECT_TRUE(canonicalText(map()) == builtOfFolder());
  EXPECT_EQ(watchUntilIdle(), 0U);
}

TEST_F(WatchedChanges, TakeTheLatestTimeOfCopies) {
  writeFile(scans() / "times.txt", "1700000500\n");
  arrive(0);
  watchThrough({[&] {
    fs::copy_file(fileOf(0), scans() / "a_copy.pcd");
    arrive(1);
    writeFile(scans() / "times.txt", "1600000000\n1700000300\n1700000400\n");
  }});
  EXPECT_EQ(watchUntilIdle(), 0U);
  EXPECT_TRUE(canonicalText(map()) == builtOfFolder());
}

TEST_F(WatchedChanges, TakeAPoseThatComesLaterAndIsTheIdentity) {
  writeUnposed(0);
  watchThrough({[&] { writeFile(scans() / "poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n"); }});
  EXPECT_TRUE(notes.has("1 of 1 scans have no pose"));
  EXPECT_TRUE(canonicalText(map()) == builtOfFolder());
}

TEST_F(WatchedChanges, GoOnBesideScansThatCannotBeRead) {
  writeFile(scans() / "broken.pcd", "no scan");
  fs::create_symlink(scans() / "nowhere", scans() / "link.pcd");
  arrive(0);
  watchUntil([&] { return scans_in_map == 1; });
  EXPECT_EQ(notes.count("broken.pcd"), 1U);
  EXPECT_EQ(notes.count("link.pcd: error: the link leads nowhere"), 1U);
  EXPECT_EQ(notes.count("tried again when the file changes"), 2U);
}

TEST_F(WatchedChanges, TellThatTheFolderHasAnotherFrameThanTheMap) {
  const fs::path manifest = scans() / "manifest.yaml";
  arrive(0);
  std::size_t looks_after = 0;
  watchUntil([&] {
    if (scans_in_map == 1 && !fs::exists(manifest))
      writeFile(manifest, "map_origin: [1000, 0, 0]\nscans:\n  - path: .\n");
    if (!notes.has("map_origin is not the map's")) return false;
    if (looks_after++ == 0) arrive(1);
    return looks_after > 6;
  });
  EXPECT_EQ(notes.count("map_origin is not the map's"), 1U);
  EXPECT_FALSE(notes.has("no longer"));
  EXPECT_EQ(scans_in_map, 1U);
  EXPECT_THROW(watchUntilIdle(), Error);  // it is so from the beginning
  fs::remove(manifest);
  EXPECT_EQ(watchUntilIdle(), 1U);
}

TEST_F(WatchedChanges, WaitForAnotherProgramThatChangesTheMap) {
  arrive(0);
  watchUntil([&] { return scans_in_map == 1; });
  arrive(1);
  auto lock = std::make_unique<BuildLock>(map());
  watchUntil([&] {
    if (notes.has("another program is changing or copying it")) lock.reset();
    return scans_in_map == 2;
  });
  EXPECT_EQ(notes.count("another program"), 1U);
}

TEST_F(WatchedChanges, TellThatTheFolderIsGone) {
  arrive(0);
  const fs::path moved = folder.path() / "moved";
  watchUntil([&] {
    if (scans_in_map == 1 && fs::exists(scans()) && !notes.has("no longer there")) fs::rename(scans(), moved);
    if (!notes.has("no longer there")) return false;
    if (!fs::exists(scans())) {
      fs::rename(moved, scans());
      arrive(1);
    }
    return scans_in_map == 2;
  });
  EXPECT_EQ(notes.count("no longer there"), 1U);
}

}  // namespace
}  // namespace cluxel::mapping
