// SPDX-License-Identifier: Apache-2.0
// Free pages become holes; what a snapshot of any process reads stays.
#include "rdf/file/space/free_pages.hpp"

#include <array>
#include <deque>
#include <map>
#include <random>

#include "rdf/file/map_check.hpp"
#include "rdf/file/space/layer_sizes.hpp"
#include "rdf/holes.hpp"
#include "rdf/lock_number.hpp"
#include "rdf/map_file_fixture.hpp"

namespace cluxel::rdf {
namespace {

class FreePages : public MapFile {
 protected:
  void SetUp() override {
    if (!hasHoles(folder_.path())) GTEST_SKIP() << "the file system has no holes";
  }
};

using Blocks = std::map<std::string, std::string>;

bool holds(const ReadTransaction& snapshot, const Blocks& blocks) {
  std::size_t count = 0;
  snapshot.forEachBlock("t", "", [&](std::string_view, std::string_view) { ++count; });
  if (count != blocks.size()) return false;
  for (const auto& [key, bytes] : blocks)
    if (snapshot.block("t", key) != bytes) return false;
  return true;
}

TEST_F(FreePages, TakeNoRoomOnTheDisk) {
  const auto environment = create();
  put(*environment, "long", std::string(4'000'000, 'a'));
  put(*environment, "other", std::string(100'000, 'b'));
  put(*environment, "long", "c");
  const auto length = std::filesystem::file_size(file_);
  EXPECT_GT(freeSpaceOf(environment->read()).freeOnDisk(), 3'900'000U);
  EXPECT_GT(releaseFreePages(*environment), 3'900'000U);
  EXPECT_LT(freeSpaceOf(environment->read()).freeOnDisk(), 200'000U);
  EXPECT_LT(diskBytes(file_), 500'000U);
  EXPECT_EQ(std::filesystem::file_size(file_), length);
  EXPECT_EQ(environment->read().block("t", "other"), std::string(100'000, 'b'));
  put(*environment, "short", "d");  // LMDB uses free pages from the second commit after on
  put(*environment, "long", std::string(3'000'000, 'e'));
  EXPECT_LE(std::filesystem::file_size(file_), length + 100'000) << "the holes were not used again";
  EXPECT_TRUE(checkMap(file_).sound());
}

/// Random changes, each followed by a release, while snapshots of up to six earlier commits are open.
TEST_F(FreePages, ThatASnapshotReadsStay) {
  const auto environment = create();
  std::mt19937 random(3);
  Blocks blocks;
  std::deque<std::pair<ReadTransaction, Blocks>> snapshots;
  std::uint64_t released = 0;
  for (int step = 0; step < 80; ++step) {
    WriteTransaction transaction = environment->write();
    for (int change = 0; change < 4; ++change) {
      const std::string key = std::to_string(random() % 30);
      if (random() % 3 == 0) {
        transaction.eraseBlock("t", key);
        blocks.erase(key);
      } else {
        const std::string bytes(random() % 200'000, static_cast<char>('a' + random() % 26));
        transaction.putBlock("t", key, bytes);
        blocks[key] = bytes;
      }
    }
    transaction.commit();
    if (random() % 2 == 0) snapshots.emplace_back(environment->read(), blocks);
    if (snapshots.size() > 6 || (random() % 8 == 0 && !snapshots.empty())) snapshots.pop_front();
    released += releaseFreePages(*environment);
    for (const auto& [snapshot, expected] : snapshots) ASSERT_TRUE(holds(snapshot, expected)) << step;
    ASSERT_TRUE(holds(environment->read(), blocks)) << step;
  }
  EXPECT_GT(released, 1'000'000U);
  snapshots.clear();
  EXPECT_TRUE(checkMap(file_).sound());
}

/// Pages that were free in the commit before.
TEST_F(FreePages, ThatTheCommitOfAKilledWriterUsesStay) {
  const std::string bytes(3'000'000, 'b');
  {
    const auto environment = create();
    put(*environment, "long", std::string(4'000'000, 'a'));
    put(*environment, "long", "c");
    put(*environment, "short", "d");  // LMDB uses free pages from the second commit after on
    put(*environment, "long", bytes);
    ASSERT_TRUE(forgetNewestCommit(file_, environment->read().commitNumber()));
    EXPECT_EQ(releaseFreePages(*environment), 0U);
  }
  EXPECT_EQ(open()->read().block("t", "long"), bytes);
  EXPECT_TRUE(checkMap(file_).sound());
}

TEST_F(FreePages, ThatAnotherProcessReadsStay) {
  std::array<int, 2> to_child{}, to_parent{};
  ASSERT_EQ(::pipe(to_child.data()) | ::pipe(to_parent.data()), 0);
  const std::string old(2'000'000, 'a');
  put(*create(), "long", old);
  const pid_t child = ::fork();
  if (child == 0) {  // reads the old commit when the new one has been released
    const ReadTransaction snapshot = open(OpenMode::ReadOnly)->read();
    char go = 'x';
    const bool told = ::write(to_parent[1], &go, 1) == 1 && ::read(to_child[0], &go, 1) == 1;
    ::_exit(told && snapshot.block("t", "long") == old ? 0 : 1);
  }
  char ready = 0;
  ASSERT_EQ(::read(to_parent[0], &ready, 1), 1);
  {
    const auto environment = open();
    put(*environment, "long", "b");
    EXPECT_LT(releaseFreePages(*environment), 1'000'000U);
  }
  ASSERT_EQ(::write(to_child[1], &ready, 1), 1);
  int status = -1;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_GT(releaseFreePages(*open()), 1'900'000U) << "nobody reads the old commit any more";
}

TEST_F(FreePages, OfAFileWithAnotherNameStay) {
  const auto environment = create();
  put(*environment, "long", std::string(2'000'000, 'a'));
  put(*environment, "long", "b");
  const std::filesystem::path link = folder_.path() / "link.clx";
  std::filesystem::create_hard_link(file_, link);
  EXPECT_EQ(releaseFreePages(*environment), 0U);
  std::filesystem::remove(link);
  EXPECT_GT(releaseFreePages(*environment), 1'900'000U);
}

TEST_F(FreePages, AreReleasedOnlyByAWriter) {
  put(*create(), "a", "b");
  const auto environment = open(OpenMode::ReadOnly);
  EXPECT_THROW(releaseFreePages(*environment), Error);
}

}  // namespace
}  // namespace cluxel::rdf
