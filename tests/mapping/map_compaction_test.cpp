// SPDX-License-Identifier: Apache-2.0
// A map is rewritten exactly when that frees much of it, and stays the same map.
#include "mapping/change/map_compaction.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file_bytes.hpp"
#include "mapping/free_space.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/file/map_check.hpp"
#include "rdf/holes.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

class MapCompaction : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new ScratchFolder();
    const SmallCampus campus({.seed = 4, .stops = 2, .size_m = 45, .points_per_stop = 3'000});
    buildMap(scansOf(campus.files()), shippedInputs(), folder->path() / "built.clx", {}, silence());
  }
  static void TearDownTestSuite() { delete folder; }

  fs::path copy() const {
    const fs::path map = folder->path() / "copy.clx";
    fs::remove(map.string() + "-lock");
    fs::copy_file(folder->path() / "built.clx", map, fs::copy_options::overwrite_existing);
    return map;
  }

  inline static ScratchFolder* folder = nullptr;
};

TEST_F(MapCompaction, FollowsMuchFreeSpaceAndKeepsTheMap) {
  const fs::path map = copy();
  const std::string facts = canonicalText(map);
  const auto before = fs::file_size(map);
  leaveFree(map, 8'000'000);
  EXPECT_GT(fs::file_size(map), before + 7'000'000);
  compactIfSparse(map, silence());
  EXPECT_LT(fs::file_size(map), before + 100'000);
  EXPECT_TRUE(canonicalText(map) == facts);
  EXPECT_FALSE(fs::exists(map.string() + ".compact"));
}

TEST_F(MapCompaction, ThatWasKilledIsFinishedByTheNextCommandThatChangesNothing) {
  const fs::path map = copy();
  const auto before = fs::file_size(map);
  leaveFree(map, 8'000'000);
  finishCompaction(map, silence());
  EXPECT_GT(fs::file_size(map), before + 7'000'000) << "none was begun";
  writeFile(map.string() + ".compact", "half of a copy");
  finishCompaction(map, silence());
  EXPECT_LT(fs::file_size(map), before + 100'000);
  EXPECT_FALSE(fs::exists(map.string() + ".compact"));
}

TEST_F(MapCompaction, LeavesAsMuchFreeSpaceAsItIsAllowedTo) {
  const fs::path map = copy();
  const auto before = fs::file_size(map);
  leaveFree(map, 8'000'000);
  const auto sparse = fs::file_size(map);
  const double free_share = static_cast<double>(sparse - before) / static_cast<double>(sparse);
  compactIfSparse(map, silence(), free_share + 0.05);
  EXPECT_EQ(fs::file_size(map), sparse);
  compactIfSparse(map, silence(), free_share - 0.05);
  EXPECT_LT(fs::file_size(map), before + 100'000);
}

TEST_F(MapCompaction, TakesANameWithoutFolder) {
  const fs::path map = copy(), before_here = fs::current_path();
  const auto before = fs::file_size(map);
  leaveFree(map, 8'000'000);
  fs::current_path(folder->path());
  compactIfSparse(map.filename(), silence());
  fs::current_path(before_here);
  EXPECT_LT(fs::file_size(map), before + 100'000);
}

TEST_F(MapCompaction, KeepsOwnerGroupAndRights) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root may give files away";
  constexpr uid_t kOther = 65534;
  const fs::path map = copy();
  leaveFree(map, 8'000'000);
  ASSERT_EQ(::chown(map.c_str(), kOther, kOther), 0);
  ASSERT_EQ(::chmod(map.c_str(), 0660), 0);
  const auto before = fs::file_size(map);
  compactIfSparse(map, silence());
  EXPECT_LT(fs::file_size(map), before);
  struct stat status {};
  ASSERT_EQ(::stat(map.c_str(), &status), 0);
  EXPECT_EQ(status.st_uid, kOther);
  EXPECT_EQ(status.st_gid, kOther);
  EXPECT_EQ(status.st_mode & 0777U, 0660U);
}

TEST_F(MapCompaction, RemovesWhatAKilledOneLeft) {
  const fs::path map = copy();
  compactIfSparse(map, silence());  // nothing is to be gained any more
  for (const char* suffix : {".compact", ".compact-lock"}) writeFile(map.string() + suffix, "left");
  compactIfSparse(map, silence());
  EXPECT_FALSE(fs::exists(map.string() + ".compact"));
  EXPECT_FALSE(fs::exists(map.string() + ".compact-lock"));
}

TEST_F(MapCompaction, LeavesAMapWithAnotherNameAloneAndTellsSo) {
  struct Notes : ProgressSink {
    void note(std::string_view text) override { all += text; }
    std::string all;
  } notes;
  const fs::path map = copy(), other = folder->path() / "other.clx";
  leaveFree(map, 8'000'000);
  fs::create_hard_link(map, other);
  compactIfSparse(map, notes);
  EXPECT_TRUE(fs::equivalent(map, other));
  EXPECT_NE(notes.all.find("hard link"), std::string::npos) << notes.all;
  try {
    compactMap(map);
    FAIL() << "the other name kept the old file";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
    EXPECT_NE(std::string_view(error.what()).find("remove the other name"), std::string_view::npos) << error.what();
  }
  EXPECT_TRUE(fs::equivalent(map, other));
  fs::remove(other);
  const std::uint64_t before = fs::file_size(map);
  const CompactedBytes bytes = compactMap(map);
  EXPECT_LT(fs::file_size(map), 8'000'000U);
  EXPECT_EQ(bytes.before, before);
  EXPECT_EQ(bytes.after, fs::file_size(map));
}

TEST_F(MapCompaction, LeavesAMapAloneThatHasLittleFreeSpace) {
  const fs::path map = copy();
  leaveFree(map, 500'000);
  const std::string bytes = readFile(map);
  compactIfSparse(map, silence());
  EXPECT_TRUE(readFile(map) == bytes);
}

TEST_F(MapCompaction, ThatFailsLeavesTheMapAndTellsWhy) {
  struct Notes : ProgressSink {
    void note(std::string_view text) override { all += text; }
    std::string all;
  } notes;
  const fs::path map = copy();
  leaveFree(map, 8'000'000);
  const std::string bytes = readFile(map);
  fs::create_directories(map.string() + ".compact/in the way");
  compactIfSparse(map, notes);
  fs::remove_all(map.string() + ".compact");
  EXPECT_TRUE(readFile(map) == bytes);
  EXPECT_NE(notes.all.find("its free space stays in the file"), std::string::npos) << notes.all;
}

TEST_F(MapCompaction, AfterAChangeFreePagesBecomeHolesThatTheNextChangeFills) {
  if (!hasHoles(folder->path())) GTEST_SKIP() << "the file system has no holes";
  constexpr std::uint64_t kMuch = 3'000'000;
  const fs::path map = copy();
  const std::string facts = canonicalText(map);
  leaveFree(map, kMuch);
  const auto length = fs::file_size(map), disk = diskBytes(map);
  {  // less than a quarter of the map, so that it is not rewritten
    const FreeSpace space{kMuch, 10 * kMuch, kMuch, 10 * kMuch};
    freeSpaceOfChange(map, space, silence());
  }
  EXPECT_EQ(fs::file_size(map), length);
  EXPECT_LT(diskBytes(map), disk - kMuch * 9 / 10);
  EXPECT_TRUE(canonicalText(map) == facts);
  EXPECT_TRUE(checkMap(map).sound());
  leaveFree(map, 10);  // LMDB uses free pages from the second commit after on
  leaveFree(map, kMuch * 8 / 10);
  EXPECT_LE(fs::file_size(map), length + kMuch / 10) << "the holes were not used again";
  EXPECT_TRUE(checkMap(map).sound());
}

TEST_F(MapCompaction, MakesHolesWhereAMapCannotBeRewritten) {
  if (!hasHoles(folder->path())) GTEST_SKIP() << "the file system has no holes";
  const fs::path map = copy();
  leaveFree(map, 8'000'000);
  const auto disk = diskBytes(map);
  fs::create_directories(map.string() + ".compact/in the way");
  freeSpaceOfChange(map, silence());
  fs::remove_all(map.string() + ".compact");
  EXPECT_LT(diskBytes(map), disk - 7'000'000);
  EXPECT_TRUE(checkMap(map).sound());
}

TEST_F(MapCompaction, FillsThePagesOfIndexes) {
  const fs::path map = copy();
  compactMap(map);
  const auto layers = MapReader(map).layers();
  std::uint64_t bytes = 0;
  for (const auto& layer : layers) bytes += layer.file_bytes;
  const FreeSpace space = freeSpaceOf(Environment::open(map, OpenMode::ReadOnly)->read());
  EXPECT_LT(space.bytes, 12U * 4096);
  EXPECT_EQ(space.file_bytes, bytes);
  const auto spog = std::find_if(layers.begin(), layers.end(), [](const auto& layer) { return layer.name == "spog"; });
  ASSERT_NE(spog, layers.end());
  EXPECT_GE(spog->file_bytes, spog->entries * 16);
}

}  // namespace
}  // namespace cluxel::mapping
