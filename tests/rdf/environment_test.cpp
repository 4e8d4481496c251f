// SPDX-License-Identifier: Apache-2.0
// Tests of opening maps, of blocks, transactions, snapshots and compact copies.
#include "rdf/file/environment.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <map>
#include <random>
#include <thread>
#include <vector>

#include "base/temporary_folder.hpp"
#include "rdf/file/commit_stamps.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/file/lmdb_handles.hpp"
#include "rdf/file/lock_file.hpp"
#include "rdf/file/map_check.hpp"
#include "rdf/file/space/layer_sizes.hpp"
#include "rdf/map_file_fixture.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(MapFile, KeepsBlocksOfAnySizeByTableAndKey) {
  std::map<std::string, std::string> blocks = {{"", "empty key"},
                                               {"a", ""},
                                               {"b", std::string(5'000'000, 'x')},
                                               {std::string("b\0c", 3), "zero in key"},
                                               {std::string(500, 'k'), "long key"}};
  {
    const auto environment = create();
    for (const auto& [key, bytes] : blocks) put(*environment, key, bytes);
    WriteTransaction transaction = environment->write();
    transaction.putBlock("s", "a", "other table");
    transaction.putBlock("tt", "a", "table with the same beginning");
    transaction.commit();
  }
  const auto environment = open(OpenMode::ReadOnly);
  const ReadTransaction transaction = environment->read();
  std::map<std::string, std::string> found;
  transaction.forEachBlock("t", "", [&](std::string_view key, std::string_view bytes) { found.emplace(key, bytes); });
  EXPECT_TRUE(found == blocks);
  EXPECT_EQ(transaction.block("s", "a"), "other table");
  EXPECT_EQ(transaction.block("s", "b"), std::nullopt);
  std::vector<std::string> keys;
  transaction.forEachBlock("t", "b", [&](std::string_view key, std::string_view) { keys.emplace_back(key); });
  EXPECT_THAT(keys, ElementsAre("b", std::string("b\0c", 3)));
}

TEST_F(MapFile, ErasesBlocksAndForgetsWhatWasNotCommitted) {
  const auto environment = create();
  put(*environment, "a", "1");
  {
    WriteTransaction transaction = environment->write();
    transaction.putBlock("t", "a", "2");
    EXPECT_EQ(transaction.block("t", "a"), "2") << "a writer sees its own changes";
    EXPECT_TRUE(transaction.eraseBlock("t", "a"));
    EXPECT_FALSE(transaction.eraseBlock("t", "a"));
  }
  EXPECT_EQ(environment->read().block("t", "a"), "1");
}

/// Regression: a block that became smaller within a transaction made the file look damaged to the next writer.
TEST_F(MapFile, BlocksThatChangeSeveralTimesInATransactionLeaveASoundFile) {
  std::mt19937 random(11);
  std::map<std::string, std::string> blocks;
  {
    const auto environment = create();
    for (int commit = 0; commit < 3; ++commit) {
      WriteTransaction transaction = environment->write();
      for (int i = 0; i < 400; ++i) {
        const std::string key = "block" + std::to_string(random() % 40);
        if (random() % 8 == 0) {
          EXPECT_EQ(transaction.eraseBlock("t", key), blocks.erase(key) == 1);
          continue;
        }
        const std::size_t size = random() % 3 == 0 ? random() % 200 : random() % 40'000;
        blocks[key] = std::string(size, static_cast<char>('a' + i % 26));
        transaction.putBlock("t", key, blocks[key]);
      }
      transaction.commit();
    }
  }
  const auto environment = open(OpenMode::ReadWrite);
  EXPECT_NO_THROW(environment->write()) << "the file is checked before a write";
  const ReadTransaction transaction = environment->read();
  std::map<std::string, std::string> found;
  transaction.forEachBlock("t", "", [&](std::string_view key, std::string_view bytes) { found.emplace(key, bytes); });
  EXPECT_TRUE(found == blocks);
}

TEST_F(MapFile, IsOneEnvironmentHoweverOftenAndByWhateverNameItIsOpened) {
  const auto environment = create();
  fs::create_symlink(file_, folder_.path() / "link.clx");
  EXPECT_EQ(open(), environment);
  EXPECT_EQ(Environment::open(folder_.path() / "link.clx", OpenMode::ReadOnly), environment);
}

TEST_F(MapFile, CanBeOpenedForWritingAfterItWasOpenedForReading) {
  create().reset();
  const auto reading = open(OpenMode::ReadOnly);
  EXPECT_THROW(reading->write(), Error);
  put(*open(OpenMode::ReadWrite), "a", "1");
  EXPECT_EQ(reading->read().block("t", "a"), "1");
}

TEST_F(MapFile, GivesReadersASnapshotWhileAWriterGoesOn) {
  const auto environment = create();
  put(*environment, "n", "0");
  std::atomic<bool> stop = false;
  std::atomic<int> torn = 0;
  std::vector<std::thread> readers;
  for (int i = 0; i < 2; ++i)
    readers.emplace_back([&] {
      while (!stop) {
        const ReadTransaction transaction = environment->read();
        const std::string first(*transaction.block("t", "n"));
        const std::size_t quads = QuadReader(transaction).size();
        std::this_thread::yield();
        torn += transaction.block("t", "n") != first || std::to_string(quads) != first ? 1 : 0;
      }
    });
  for (TermId i = 1; i <= 60; ++i) {
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    writer.add(QuadIds{i, i, i, 0});
    writer.flush();
    transaction.putBlock("t", "n", std::to_string(i));
    transaction.commit();
  }
  stop = true;
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(torn, 0);
}

TEST_F(MapFile, LetsWritersOfOneProcessTakeTurns) {
  const auto environment = Environment::temporary();
  std::vector<std::thread> writers;
  for (int i = 0; i < 4; ++i)
    writers.emplace_back([&] {
      for (int j = 0; j < 25; ++j) {
        WriteTransaction transaction = environment->write();
        const auto stored = transaction.block("t", "n");
        transaction.putBlock("t", "n", std::to_string(stored ? std::stoi(std::string(*stored)) + 1 : 1));
        transaction.commit();
      }
    });
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(environment->read().block("t", "n"), "100");
}

TEST_F(MapFile, IsNotMadeWhereAFileIs) {
  create().reset();
  EXPECT_THAT(refusal(OpenMode::Create), HasSubstr("exists already"));
}

/// A compaction commits after each 128 MiB.
TEST_F(MapFile, CompactsALargeMapInSeveralCommits) {
  constexpr int kBlocks = 300;
  constexpr std::size_t kBlockBytes = std::size_t{1} << 20U;
  const auto bytesOf = [](int block) { return std::string(kBlockBytes, static_cast<char>(block)); };
  const fs::path target = folder_.path() / "compact.clx";
  {
    const auto environment = create();
    WriteTransaction transaction = environment->write();
    for (int i = 0; i < kBlocks; ++i) transaction.putBlock("t", std::to_string(i), bytesOf(i));
    QuadWriter writer(transaction);
    for (int i = 0; i < 5000; ++i) writer.add({Term::integer(i), Term::iri("p"), Term::iri("o"), Term::iri("")});
    writer.flush();
    transaction.commit();
    environment->compactTo(target);
  }
  EXPECT_LT(fs::file_size(target), (kBlocks + 4) * kBlockBytes);
  EXPECT_TRUE(checkMap(target).sound());
  const ReadTransaction copy = Environment::open(target, OpenMode::ReadOnly)->read();
  EXPECT_GT(mdb_txn_id(copy.impl().live()), 3U) << "the tables, two full commits and the rest";
  EXPECT_EQ(QuadReader(copy).size(), 5000U);
  for (int i = 0; i < kBlocks; ++i) ASSERT_EQ(copy.block("t", std::to_string(i)), bytesOf(i)) << i;
}

/// The commits of a copy are numbered anew, so that an old stamp may have the number of one of them.
TEST_F(MapFile, CopiesTheStampsOfTheLastCommitOnly) {
  const auto environment = create();
  const auto commit = [&](std::initializer_list<std::string_view> stamped) {
    WriteTransaction transaction = environment->write();
    transaction.putBlock("t", "a", std::to_string(transaction.commitNumber()));
    for (const std::string_view name : stamped) {
      stampCommit(transaction, name);
      EXPECT_TRUE(hasStamp(transaction, name));
    }
    transaction.commit();
  };
  const std::array kOld = {"old 1", "old 2", "old 3", "old 4"};
  for (const std::string_view name : kOld) commit({name});
  commit({"last", "too"});
  for (const CopiedPages pages : {CopiedPages::Filled, CopiedPages::AsTheyAre}) {
    const fs::path target = folder_.path() / (pages == CopiedPages::Filled ? "filled.clx" : "copy.clx");
    environment->compactTo(target, pages);
    EXPECT_TRUE(checkMap(target).sound());
    const auto copy = Environment::open(target, OpenMode::ReadWrite);
    const auto stamps = [&] {
      const ReadTransaction transaction = copy->read();
      std::vector<std::string_view> found;
      for (const std::string_view name : {"old 1", "old 2", "old 3", "old 4", "last", "too", "unknown"})
        if (hasStamp(transaction, name)) found.push_back(name);
      return found;
    };
    EXPECT_THAT(stamps(), ElementsAre("last", "too"));
    for (int i = 0; i < 5; ++i) {
      WriteTransaction transaction = copy->write();
      transaction.putBlock("t", "b", std::to_string(i));
      transaction.commit();
      EXPECT_THAT(stamps(), IsEmpty()) << "nobody stamped commit " << copy->read().commitNumber();
    }
  }
}

TEST_F(MapFile, CompactsIntoASmallerMapWithTheSameContents) {
  const auto environment = create();
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    for (int j = 0; j < 300; ++j)
      writer.add({Term::iri("s" + std::to_string(random() % 500)), Term::iri("p"), Term::integer(random() % 900),
                  Term::iri("")});
    writer.flush();
    transaction.putBlock("t", "a", std::string(100'000, static_cast<char>('a' + i)));
    transaction.commit();
  }
  for (const CopiedPages pages : {CopiedPages::Filled, CopiedPages::AsTheyAre}) {
    const fs::path target = folder_.path() / (pages == CopiedPages::Filled ? "small.clx" : "copy.clx");
    environment->compactTo(target, pages);
    EXPECT_LT(fs::file_size(target), fs::file_size(file_));
    EXPECT_THROW(environment->compactTo(target, pages), Error) << "an existing file is not overwritten";
    EXPECT_FALSE(fs::exists(lockFileOf(target)));
    EXPECT_TRUE(checkMap(target).sound());
    const FreeSpace space = freeSpaceOf(Environment::open(target, OpenMode::ReadOnly)->read());
    EXPECT_LE(20 * space.in_free_pages, space.file_bytes);
    const std::uint64_t in_used_pages = space.bytes - space.in_free_pages;
    EXPECT_EQ(10 * in_used_pages > space.file_bytes, pages == CopiedPages::AsTheyAre) << "pages were filled, or not";
    const auto copy = Environment::open(target, OpenMode::ReadOnly);
    const ReadTransaction before = environment->read();
    const ReadTransaction after = copy->read();
    EXPECT_EQ(after.block("t", "a"), before.block("t", "a"));
    const QuadReader old_reader(before);
    const QuadReader new_reader(after);
    ASSERT_EQ(new_reader.size(), old_reader.size());
    for (TermId id = 1; id <= old_reader.termCount(); ++id) ASSERT_EQ(new_reader.termOf(id), old_reader.termOf(id));
    QuadCursor old_quads = old_reader.scan({}, QuadOrder::Posg);
    QuadCursor new_quads = new_reader.scan({}, QuadOrder::Posg);
    for (QuadIds one, other; old_quads.next(one);) {
      ASSERT_TRUE(new_quads.next(other));
      ASSERT_EQ(one, other);
    }
    // The copy goes on as any other map.
    const auto writing = Environment::open(target, OpenMode::ReadWrite);
    WriteTransaction transaction = writing->write();
    QuadWriter writer(transaction);
    writer.add({Term::iri("new"), Term::iri("p"), Term::integer(1), Term::iri("")});
    writer.flush();
    transaction.commit();
    EXPECT_EQ(QuadReader(writing->read()).size(), old_reader.size() + 1);
    EXPECT_TRUE(checkMap(target).sound());
  }
}

TEST_F(MapFile, ATemporaryOneLeavesNothingBehind) {
  {
    const TemporaryFolderIs used(folder_.path());
    const auto environment = Environment::temporary();
    put(*environment, "a", "1");
    EXPECT_EQ(environment->read().block("t", "a"), "1");
    EXPECT_TRUE(fs::is_empty(folder_.path()));
  }
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST(StoreErrors, TellWhatTheSystemRefused) {
  const auto told = [](int code) {
    try {
      failStore("there.clx", code, "open the map");
    } catch (const Error& fault) {
      EXPECT_EQ(fault.kind(), ErrorKind::StoreUnavailable);
      return std::string(fault.what());
    }
  };
  EXPECT_EQ(told(EROFS),
            "there.clx: cannot open the map: the file system is read-only; write to another one, or mount it for "
            "writing");
  EXPECT_THAT(told(EACCES), HasSubstr("permission denied; check the rights"));
  EXPECT_THAT(told(ENOMEM), HasSubstr("no address space is left; raise the limit"));
  EXPECT_THAT(told(EDQUOT), HasSubstr("no space is left on the disk"));
}

}  // namespace
}  // namespace cluxel::rdf
