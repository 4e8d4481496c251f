// SPDX-License-Identifier: Apache-2.0
// Tests of maps that are moved, exchanged or named twice while processes have them open: no commit is lost.
#include <fcntl.h>
#include <lmdb.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <thread>

#include "rdf/file/file_guards.hpp"
#include "rdf/file/lock_file.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/lock_number.hpp"
#include "rdf/map_file_fixture.hpp"
#include "rdf/other_process.hpp"

namespace cluxel::rdf {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// Has a map open, and reads block "one" when its time is over.
std::function<int(const Pause&)> holding(const fs::path& file, const std::string& expected = "0") {
  return [=](const Pause& pause) {
    const auto environment = Environment::open(file, OpenMode::ReadOnly);
    const ReadTransaction snapshot = environment->read();
    pause();
    return environment->read().block("t", "one") == expected && snapshot.block("t", "one") == "0" ? 0 : 1;
  };
}

class MapNames : public MapFile {
 protected:
  fs::path named(const std::string& name) const { return folder_.path() / name; }

  static void putIn(const fs::path& file, std::string_view key, std::string_view bytes) {
    WriteTransaction transaction = writeMap(file);
    transaction.putBlock("t", key, bytes);
    transaction.commit();
  }
  static std::string blockOf(const fs::path& file, std::string_view key) {
    return std::string(Environment::open(file, OpenMode::ReadOnly)->read().block("t", key).value_or("none"));
  }
  static std::string refusalOfWriting(const fs::path& file) {
    try {
      putIn(file, "refused", "1");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
      return error.what();
    }
    return "written";
  }
  /// As `cp map.clx new.clx`, some commits, and `mv new.clx map.clx`.
  void exchange(int commits) {
    const fs::path fresh = named("new.clx");
    fs::copy_file(file_, fresh);
    for (int i = 1; i <= commits; ++i) putIn(fresh, "one", std::to_string(i));
    fs::rename(fresh, file_);
  }
};

TEST_F(MapNames, AMapMovedOverOneThatIsOpenKeepsItsCommits) {
  for (const int commits : {0, 1, 2, 3}) {
    SCOPED_TRACE(std::to_string(commits) + " commits ahead");
    fs::remove(file_);
    create().reset();
    putIn(file_, "one", "0");
    OtherProcess holder(holding(file_));
    exchange(commits);
    EXPECT_EQ(blockOf(file_, "one"), std::to_string(commits));
    putIn(file_, "two", "2");
    putIn(file_, "two", "3");
    EXPECT_EQ(blockOf(file_, "one"), std::to_string(commits));
    EXPECT_EQ(blockOf(file_, "two"), "3");
    EXPECT_EQ(holder.end(), 0) << "it goes on with the old file";
  }
}

/// The process that reads the old file opens the new one.
TEST_F(MapNames, AProcessReadsAMapThatIsMovedOverTheOneItHasOpen) {
  create().reset();
  putIn(file_, "one", "0");
  const auto old = open(OpenMode::ReadOnly);
  const ReadTransaction before = old->read();
  exchange(1);
  const auto fresh = open();
  EXPECT_EQ(fresh->read().block("t", "one"), "1");
  put(*fresh, "two", "2");
  EXPECT_EQ(fresh->read().block("t", "two"), "2");
  EXPECT_EQ(old->read().block("t", "one"), "0");
  EXPECT_EQ(before.block("t", "one"), "0");
  EXPECT_EQ(inChild([&] { return blockOf(file_, "two") == "2" ? 0 : 1; }), 0);
}

TEST_F(MapNames, AMapThatIsOpenAndWasMovedIsNotWrittenUnderItsNewName) {
  create().reset();
  putIn(file_, "one", "0");
  OtherProcess holder(holding(file_));
  const fs::path moved = named("moved.clx");
  fs::rename(file_, moved);
  EXPECT_EQ(blockOf(moved, "one"), "0");
  EXPECT_THAT(refusalOfWriting(moved), HasSubstr("under another name"));
  fs::rename(moved, file_);
  putIn(file_, "one", "1");
  EXPECT_EQ(blockOf(file_, "one"), "1");
  fs::rename(file_, moved);
  holder.end();
  putIn(moved, "one", "2");
  EXPECT_EQ(blockOf(moved, "one"), "2");
}

TEST_F(MapNames, AMapThatIsOpenUnderAHardLinkIsNotWritten) {
  create().reset();
  putIn(file_, "one", "0");
  const fs::path link = named("link.clx");
  fs::create_hard_link(file_, link);
  OtherProcess holder(holding(link));
  EXPECT_EQ(blockOf(file_, "one"), "0");
  EXPECT_THAT(refusalOfWriting(file_), AllOf(HasSubstr("hard link"), HasSubstr("container")));
  EXPECT_EQ(holder.end(), 0);
  putIn(file_, "one", "1");
  EXPECT_EQ(blockOf(link, "one"), "1");
  putIn(link, "two", "2");
  EXPECT_EQ(blockOf(file_, "one") + blockOf(file_, "two"), "12");
}

/// A lock file is made with the number of the commit before, while the first writer is at work.
TEST_F(MapNames, AWriterUnderAHardLinkWaitsForAnotherAndBuildsOnItsCommit) {
  create().reset();
  putIn(file_, "one", "0");
  const fs::path link = named("link.clx");
  fs::create_hard_link(file_, link);
  OtherProcess first([&](const Pause& pause) {
    WriteTransaction transaction = writeMap(file_);
    transaction.putBlock("t", "one", "1");
    pause();
    transaction.commit();
    return 0;
  });
  std::thread ending([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_EQ(first.end(), 0);
  });
  EXPECT_NO_THROW(putIn(link, "two", "2"));
  ending.join();
  EXPECT_EQ(blockOf(file_, "one") + blockOf(file_, "two"), "12");
}

/// The number stays wrong as long as one process has the map open.
TEST_F(MapNames, AWriterWaitsUntilALockFileThatIsOutOfDateIsClosed) {
  create().reset();
  putIn(file_, "one", "0");
  putIn(file_, "one", "1");
  const std::uint64_t newest = open(OpenMode::ReadOnly)->read().commitNumber();
  OtherProcess holder([&](const Pause& pause) {
    const auto environment = open(OpenMode::ReadOnly);
    pause();
    return 0;
  });
  ASSERT_TRUE(forgetNewestCommit(file_, newest));
  EXPECT_THAT(refusalOfWriting(file_), HasSubstr("out of date"));
  std::thread ending([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_EQ(holder.end(), 0);
  });
  EXPECT_NO_THROW(putIn(file_, "two", "2"));
  ending.join();
  EXPECT_EQ(blockOf(file_, "one") + blockOf(file_, "two"), "12");
}

/// The lock file gets the number of a commit after the map: here the other process is between the two.
TEST_F(MapNames, AReaderDoesNotWaitWithAThreadThatWaitsForAnotherProcessToWrite) {
  create().reset();
  putIn(file_, "one", "0");
  putIn(file_, "one", "1");
  OtherProcess first([&](const Pause& pause) {
    WriteTransaction transaction = writeMap(file_);
    transaction.putBlock("t", "two", "2");
    pause();
    transaction.commit();
    return 0;
  });
  const auto environment = open();
  ASSERT_TRUE(forgetNewestCommit(file_, environment->read().commitNumber()));
  std::atomic<bool> has_begun{false}, is_refused{false};
  std::thread waiting([&] {
    has_begun = true;
    EXPECT_THROW(environment->write(), MapBusy);
    is_refused = true;
  });
  while (!has_begun) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(environment->read().block("t", "one"), "0");
  EXPECT_FALSE(is_refused) << "the reader waited";
  waiting.join();
  EXPECT_EQ(first.end(), 0);
  EXPECT_EQ(environment->read().block("t", "one"), "1");
  EXPECT_EQ(environment->read().block("t", "two"), "2");
}

/// As Python's multiprocessing does: the child has a copy of what the parent has open.
TEST_F(MapNames, AChildThatClosesAMapLeavesItOpenInItsParent) {
  create().reset();
  putIn(file_, "one", "0");
  const fs::path link = named("link.clx");
  fs::create_hard_link(file_, link);
  OtherProcess holder([&](const Pause& pause) {
    auto environment = open(OpenMode::ReadOnly);
    const int result = inChild([&] {
      environment.reset();
      return 0;
    });
    pause();
    return result;
  });
  EXPECT_THAT(refusalOfWriting(link), HasSubstr("hard link"));
  EXPECT_EQ(holder.end(), 0);
  putIn(link, "one", "1");
  EXPECT_EQ(blockOf(file_, "one"), "1");
}

/// A reader who copies the map writes nothing to it.
TEST_F(MapNames, WhoMayOnlyReadRunsBesideOthersWhoReadAndNotBesideAWriter) {
  create().reset();
  const Descriptor own(::open(file_.c_str(), O_RDONLY | O_CLOEXEC)), other(::open(file_.c_str(), O_RDWR | O_CLOEXEC));
  int runs = 0;
  ASSERT_TRUE(tryLockAgainstWriters(other.get(), WriteLock::Copying, file_));
  EXPECT_TRUE(runWithoutWriters(own.get(), file_, [&] { ++runs; }));
  ASSERT_TRUE(tryLockAgainstWriters(other.get(), WriteLock::Writing, file_));
  EXPECT_FALSE(runWithoutWriters(own.get(), file_, [&] { ++runs; }));
  EXPECT_EQ(runs, 1);
}

TEST_F(MapNames, AReaderUnderAHardLinkMissesNoCommitOfAWriterThatHadBegun) {
  create().reset();
  putIn(file_, "one", "0");
  const fs::path link = named("link.clx");
  fs::create_hard_link(file_, link);
  OtherProcess writer([&](const Pause& pause) {
    WriteTransaction transaction = writeMap(link);
    transaction.putBlock("t", "one", "1");
    pause();
    transaction.commit();
    return 0;
  });
  const auto early = open(OpenMode::ReadOnly);
  EXPECT_EQ(early->read().block("t", "one"), "0");
  EXPECT_EQ(writer.end(), 0);
  EXPECT_EQ(blockOf(file_, "one"), "1");
  putIn(file_, "two", "2");
  EXPECT_EQ(blockOf(link, "one") + blockOf(link, "two"), "12");
}

TEST_F(MapNames, AMapWhoseLockFileWasRemovedWhileItIsOpenIsNotWritten) {
  create().reset();
  putIn(file_, "one", "0");
  OtherProcess holder(holding(file_));
  fs::remove(lockFileOf(file_));
  EXPECT_THAT(refusalOfWriting(file_), HasSubstr("lock file that was removed"));
  holder.end();
  putIn(file_, "one", "1");
  EXPECT_EQ(blockOf(file_, "one"), "1");
}

std::string bytesOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// What a file of the system holds when `bytes` are written over it, the meta pages last.
void overwrite(const fs::path& file, const std::string& bytes) {
  constexpr std::size_t kMetaPages = 8192;
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
  const std::size_t rest = bytes.size() - kMetaPages;
  EXPECT_EQ(::pwrite(descriptor, bytes.data() + kMetaPages, rest, kMetaPages), static_cast<ssize_t>(rest));
  EXPECT_EQ(::pwrite(descriptor, bytes.data(), kMetaPages, 0), static_cast<ssize_t>(kMetaPages));
  ::close(descriptor);
}

/// Between the two moments at which the file and its lock file get the number of the commit.
TEST_F(MapNames, ACommitWhoseProcessWasKilledAtItsVeryEndIsSeen) {
  create().reset();
  putIn(file_, "one", "0");
  const std::string before = bytesOf(file_);
  putIn(file_, "one", "1");
  const std::string after = bytesOf(file_);
  fs::resize_file(file_, before.size());
  overwrite(file_, before);
  OtherProcess holder(holding(file_, "1"));
  EXPECT_EQ(inChild([&] {
              MDB_env* environment = nullptr;
              MDB_txn* writing = nullptr;
              mdb_env_create(&environment);
              if (mdb_env_open(environment, file_.c_str(), MDB_NOSUBDIR | MDB_NOTLS, 0666) != 0 ||
                  mdb_txn_begin(environment, nullptr, 0, &writing) != 0)
                return 1;
              overwrite(file_, after);
              return 0;  // with LMDB's lock
            }),
            0);
  EXPECT_EQ(holder.end(), 0);
  putIn(file_, "two", "2");
  EXPECT_EQ(blockOf(file_, "one") + blockOf(file_, "two"), "12");
}

}  // namespace
}  // namespace cluxel::rdf
