// SPDX-License-Identifier: Apache-2.0
// Opening, blocks, transactions, other processes, broken files.
#include "cluxel/knowledge/environment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lmdb.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <random>
#include <thread>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/base/file_bytes.hpp"
#include "cluxel/knowledge/map_check.hpp"
#include "cluxel/knowledge/quad_store.hpp"
#include "knowledge/scratch_folder.hpp"

namespace cluxel {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class MapFile : public testing::Test {
 protected:
  std::shared_ptr<Environment> create() { return Environment::open(file_, OpenMode::Create); }
  std::shared_ptr<Environment> open(OpenMode mode = OpenMode::ReadWrite) {
    return Environment::open(file_, mode);
  }

  static void put(Environment& environment, std::string_view key, std::string_view bytes) {
    WriteTransaction transaction = environment.write();
    transaction.putBlock("t", key, bytes);
    transaction.commit();
  }

  std::string refusal(OpenMode mode = OpenMode::ReadOnly) {
    try {
      open(mode);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::StoreUnavailable);
      EXPECT_THAT(error.what(), HasSubstr("map.clx"));
      return error.what();
    }
    return "opened";
  }

  /// Runs `work` in a child process; its exit status, or minus the signal that ended it.
  template <typename Work>
  static int inChild(const Work& work) {
    const pid_t child = ::fork();
    if (child == 0) {
      int result = 99;
      try {
        result = work();
      } catch (const Error& error) {
        result = 50 + static_cast<int>(error.code());
      } catch (...) {
      }
      ::_exit(result);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  }

  ScratchFolder folder_;
  fs::path file_ = folder_.path() / "map.clx";
};

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
  transaction.forEachBlock("t", "",
                           [&](std::string_view key, std::string_view bytes) { found.emplace(key, bytes); });
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

TEST_F(MapFile, RefusesASecondWritingProcessAndLetsItWriteAfterwards) {
  create().reset();
  int to_child[2];
  int to_parent[2];
  ASSERT_EQ(::pipe(to_child) | ::pipe(to_parent), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    char byte = 'r';
    {
      const auto environment = open();
      WriteTransaction transaction = environment->write();
      transaction.putBlock("t", "child", "1");
      const bool told = ::write(to_parent[1], &byte, 1) == 1 && ::read(to_child[0], &byte, 1) == 1;
      if (told) transaction.commit();
    }
    ::_exit(0);
  }
  char byte = 0;
  ASSERT_EQ(::read(to_parent[0], &byte, 1), 1);
  {
    const auto environment = open();
    try {
      environment->write();
      ADD_FAILURE() << "two processes write";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::StoreUnavailable);
      EXPECT_THAT(error.what(), HasSubstr("another process is writing"));
    }
    EXPECT_EQ(environment->read().block("t", "child"), std::nullopt);
    ASSERT_EQ(::write(to_child[1], &byte, 1), 1);
    int status = 0;
    ::waitpid(child, &status, 0);
    put(*environment, "parent", "1");
    EXPECT_EQ(environment->read().block("t", "child"), "1");
  }
}

TEST_F(MapFile, IsAnEarlierCommitAfterTheWriterWasKilled) {
  create().reset();
  std::mt19937 random(3);
  for (int round = 0; round < 6; ++round) {
    int pipe_ends[2];
    ASSERT_EQ(::pipe(pipe_ends), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      const auto environment = open();
      for (TermId n = 0;; ++n) {
        WriteTransaction transaction = environment->write();
        QuadWriter writer(transaction);
        const QuadReader reader(transaction);
        const auto count = static_cast<TermId>(reader.size());
        for (TermId i = 1; i <= 500; ++i) writer.add(QuadIds{count + i, 1, i, 0});
        writer.intern(Term::literal("number " + std::to_string(count)));
        writer.flush();
        transaction.putBlock("t", "count", std::to_string(count + 500));
        transaction.commit();
        if (::write(pipe_ends[1], "c", 1) != 1) ::_exit(1);
      }
    }
    char byte = 0;
    for (int commits = 0; commits < 2; ++commits) ASSERT_EQ(::read(pipe_ends[0], &byte, 1), 1);
    ::usleep(static_cast<useconds_t>(random() % 3000));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    ::close(pipe_ends[0]);
    ::close(pipe_ends[1]);
    const auto environment = open();
    const ReadTransaction transaction = environment->read();
    const QuadReader reader(transaction);
    EXPECT_EQ(std::to_string(reader.size()), transaction.block("t", "count"));
    EXPECT_EQ(reader.size() % 500, 0U);
    EXPECT_EQ(reader.termCount(), reader.size() / 500);
    for (const QuadOrder order : {QuadOrder::Posg, QuadOrder::Ospg, QuadOrder::Gspo}) {
      std::uint64_t count = 0;
      QuadCursor cursor = reader.scan({}, order);
      for (QuadIds quad; cursor.next(quad);) ++count;
      EXPECT_EQ(count, reader.size());
    }
  }
}

TEST_F(MapFile, KeepsItsLastCommitWhenTheDiskIsFull) {
  create().reset();
  const int result = inChild([&] {
    const auto environment = open();
    put(*environment, "a", "kept");
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1U << 20U, 1U << 20U};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      put(*environment, "b", std::string(8U << 20U, 'x'));
    } catch (const Error& error) {
      return std::string_view(error.what()).find("no space is left") != std::string_view::npos ? 0 : 1;
    }
    return 2;
  });
  EXPECT_EQ(result, 0);
  EXPECT_EQ(open()->read().block("t", "a"), "kept");
  EXPECT_EQ(open()->read().block("t", "b"), std::nullopt);
}

TEST_F(MapFile, WorksInLittleAddressSpace) {
  create().reset();
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(__clang__)
  GTEST_SKIP() << "sanitizers need the address space themselves, and Clang builds are for them";
#endif
  const int result = inChild([&] {
    const rlimit limit{4ULL << 30U, 4ULL << 30U};
    ::setrlimit(RLIMIT_AS, &limit);
    const auto environment = open();
    put(*environment, "a", std::string(1U << 20U, 'x'));
    return environment->read().block("t", "a")->size() == 1U << 20U ? 0 : 1;
  });
  EXPECT_EQ(result, 0);
}

TEST_F(MapFile, RefusesWhatIsNoMapInPlainWords) {
  EXPECT_THAT(refusal(), HasSubstr("no such file"));
  std::ofstream(file_).close();
  EXPECT_THAT(refusal(), HasSubstr("is empty"));
  std::ofstream(file_) << std::string(100'000, 'x');
  EXPECT_THAT(refusal(), HasSubstr("not a Cluxel map"));
  std::ofstream(file_) << "short";
  EXPECT_THAT(refusal(), HasSubstr("not a Cluxel map"));
  fs::remove(file_);
  fs::create_directory(file_);
  EXPECT_THAT(refusal(), HasSubstr("folder"));
}

TEST_F(MapFile, IsNotMadeWhereAFileIs) {
  create().reset();
  EXPECT_THAT(refusal(OpenMode::Create), HasSubstr("exists already"));
}

/// Opens the file with LMDB itself, to make what the library would not.
template <typename Work>
void withLmdb(const fs::path& file, const Work& work) {
  MDB_env* environment = nullptr;
  MDB_txn* transaction = nullptr;
  MDB_dbi main = 0;
  ASSERT_EQ(mdb_env_create(&environment), 0);
  ASSERT_EQ(mdb_env_open(environment, file.c_str(), MDB_NOSUBDIR, 0666), 0);
  ASSERT_EQ(mdb_txn_begin(environment, nullptr, 0, &transaction), 0);
  ASSERT_EQ(mdb_dbi_open(transaction, nullptr, 0, &main), 0);
  work(transaction, main);
  ASSERT_EQ(mdb_txn_commit(transaction), 0);
  mdb_env_close(environment);
}

void putText(MDB_txn* transaction, MDB_dbi table, std::string key, std::string value) {
  MDB_val stored_key{key.size(), key.data()};
  MDB_val stored_value{value.size(), value.data()};
  ASSERT_EQ(mdb_put(transaction, table, &stored_key, &stored_value, 0), 0);
}

TEST_F(MapFile, RefusesANewerFormatAndForeignLmdbFiles) {
  withLmdb(file_, [](MDB_txn* transaction, MDB_dbi main) { putText(transaction, main, "other", "x"); });
  EXPECT_THAT(refusal(), HasSubstr("not a Cluxel map"));
  fs::remove(file_);
  create().reset();
  withLmdb(file_,
           [](MDB_txn* transaction, MDB_dbi main) { putText(transaction, main, "cluxel-format", "2"); });
  EXPECT_THAT(refusal(), HasSubstr("newer format (2; this program reads 1)"));
}

TEST_F(MapFile, RefusesAFileThatIsCutShort) {
  {
    const auto environment = create();
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    for (TermId i = 1; i < 20'000; ++i) writer.add(QuadIds{i, 1, i, 0});
    writer.flush();
    transaction.commit();
  }
  const auto size = fs::file_size(file_);
  for (const std::uintmax_t part : {size - 4096, size / 2, std::uintmax_t{20'000}, std::uintmax_t{8192}}) {
    fs::resize_file(file_, part);
    EXPECT_THAT(refusal(), testing::AnyOf(HasSubstr("damaged"), HasSubstr("not a Cluxel map"))) << part;
  }
}

TEST_F(MapFile, FindsAChangedByteInABlock) {
  put(*create(), "a", std::string(10'000, 'x'));
  std::string bytes = readFile(file_);
  const std::size_t at = bytes.find(std::string(5'000, 'x'));
  ASSERT_NE(at, std::string::npos);
  bytes[at + 100] = 'y';
  std::ofstream(file_, std::ios::binary) << bytes;
  const auto environment = open(OpenMode::ReadOnly);
  EXPECT_THROW(environment->read().block("t", "a"), Error);
}

TEST_F(MapFile, IsFoundSoundOrDamagedAsAWhole) {
  {
    const auto environment = create();
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    for (int i = 1; i < 3'000; ++i)
      writer.add({Term::iri("s" + std::to_string(i % 700)), Term::iri("p"), Term::integer(i), Term::iri("")});
    writer.flush();
    transaction.putBlock("t", "a", std::string(10'000, 'x'));
    transaction.commit();
  }
  const MapCheck sound = checkMap(file_);
  EXPECT_THAT(sound.faults, ElementsAre());
  EXPECT_EQ(sound.quads, 2'999U);
  EXPECT_EQ(sound.blocks, 1U);
  EXPECT_EQ(sound.terms, 700U + 2'999 + 2);  // subjects, numbers, the predicate and xsd:integer
  const std::string bytes = readFile(file_);
  std::mt19937 random(11);
  int found = 0;
  for (int i = 0; i < 300; ++i) {
    std::string damaged = bytes;
    const std::size_t at = 8192 + random() % (bytes.size() - 8192);
    damaged[at] = static_cast<char>(damaged[at] ^ (1U << (random() % 8)));
    std::ofstream(file_, std::ios::binary) << damaged;
    try {
      found += checkMap(file_).sound() ? 0 : 1;
    } catch (const Error&) {
      ++found;
    }
  }
  EXPECT_GT(found, 150) << "most bytes of the file are in use";
}

TEST_F(MapFile, CompactsIntoASmallerMapWithTheSameContents) {
  const auto environment = create();
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    for (int j = 0; j < 300; ++j)
      writer.add({Term::iri("s" + std::to_string(random() % 500)), Term::iri("p"),
                  Term::integer(random() % 900), Term::iri("")});
    writer.flush();
    transaction.putBlock("t", "a", std::string(100'000, static_cast<char>('a' + i)));
    transaction.commit();
  }
  const fs::path target = folder_.path() / "small.clx";
  environment->compactTo(target);
  EXPECT_LT(fs::file_size(target), fs::file_size(file_));
  EXPECT_THROW(environment->compactTo(target), Error) << "an existing file is not overwritten";
  const auto copy = Environment::open(target, OpenMode::ReadOnly);
  const ReadTransaction before = environment->read();
  const ReadTransaction after = copy->read();
  EXPECT_EQ(after.block("t", "a"), before.block("t", "a"));
  const QuadReader old_reader(before);
  const QuadReader new_reader(after);
  ASSERT_EQ(new_reader.size(), old_reader.size());
  for (TermId id = 1; id <= old_reader.termCount(); ++id)
    ASSERT_EQ(new_reader.termOf(id), old_reader.termOf(id));
  QuadCursor old_quads = old_reader.scan({}, QuadOrder::Posg);
  QuadCursor new_quads = new_reader.scan({}, QuadOrder::Posg);
  for (QuadIds one, other; old_quads.next(one);) {
    ASSERT_TRUE(new_quads.next(other));
    ASSERT_EQ(one, other);
  }
}

TEST_F(MapFile, ATemporaryOneLeavesNothingBehind) {
  ::setenv("TMPDIR", folder_.path().c_str(), 1);
  {
    const auto environment = Environment::temporary();
    put(*environment, "a", "1");
    EXPECT_EQ(environment->read().block("t", "a"), "1");
    EXPECT_TRUE(fs::is_empty(folder_.path()));
  }
  ::unsetenv("TMPDIR");
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

}  // namespace
}  // namespace cluxel
