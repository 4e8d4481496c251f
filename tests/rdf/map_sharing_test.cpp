// SPDX-License-Identifier: Apache-2.0
// Maps of other users: a reader without a place in the lock file reads one commit, and locks nobody out.
#include <sys/stat.h>

#include <chrono>
#include <filesystem>

#include "rdf/file/map_replacement.hpp"
#include "rdf/file/private_copy.hpp"
#include "rdf/file/space/free_pages.hpp"
#include "rdf/holes.hpp"
#include "rdf/lock_number.hpp"
#include "rdf/map_file_fixture.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kBlocks = 200;
constexpr uid_t kNobody = 65534;

class SharedMap : public MapFile {
 protected:
  SharedMap() { ::chmod(folder_.path().c_str(), 0755); }

  fs::path lockFile() const { return file_.string() + "-lock"; }

  static void putGeneration(Environment& environment, int generation) {
    WriteTransaction transaction = environment.write();
    for (int i = 0; i < kBlocks; ++i)
      transaction.putBlock("t", std::to_string(i), std::string(3'000, static_cast<char>('a' + generation % 26)));
    transaction.commit();
  }

  /// From now on this process is another user; without root's rights it stays who it is, and loses the right to write.
  void becomeAnotherUser() const {
    if (::geteuid() == 0 && (::setgid(kNobody) != 0 || ::setuid(kNobody) != 0)) ::_exit(98);
  }
  /// The map and its lock file can be read by all and written by nobody but root.
  void takeRightToWrite() const {
    for (const fs::path& file : {file_, lockFile()})
      if (fs::exists(file)) ::chmod(file.c_str(), 0444);
  }

  /// 0 when all blocks are of one commit.
  static int readAll(const ReadTransaction& transaction) {
    const std::string first(*transaction.block("t", "0"));
    for (int i = 0; i < kBlocks; ++i)
      if (const auto block = transaction.block("t", std::to_string(i)); !block || *block != first) return 1;
    return 0;
  }
};

/// Pipes to and from a child process.
struct Talk {
  int to_child[2], to_parent[2];
  char byte = 'x';
  Talk() {
    if ((::pipe(to_child) | ::pipe(to_parent)) != 0) std::abort();
  }
  void tellChild() { (void)!::write(to_child[1], &byte, 1); }
  void tellParent() { (void)!::write(to_parent[1], &byte, 1); }
  void hearChild() { (void)!::read(to_parent[0], &byte, 1); }
  void hearParent() { (void)!::read(to_child[0], &byte, 1); }
};

/// The child must not inherit an open map, so it is made before the owner opens it.
TEST_F(SharedMap, AReaderThatMayNotWriteTheLockFileReadsOneCommitWhileTheOwnerWrites) {
  putGeneration(*create(), 0);
  Talk talk;
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(60);
    int result = 97;
    talk.hearParent();
    becomeAnotherUser();
    try {
      const auto environment = open(OpenMode::ReadOnly);
      const ReadTransaction transaction = environment->read();
      talk.tellParent();
      talk.hearParent();
      result = readAll(transaction);
    } catch (const Error&) {
      result = 50;
    }
    ::_exit(result);
  }
  const auto owner = open();
  takeRightToWrite();
  talk.tellChild();
  talk.hearChild();
  for (int generation = 1; generation < 40; ++generation) putGeneration(*owner, generation);
  talk.tellChild();
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(SharedMap, AReaderThatMayNotWriteTheMapSeesTheCommitOfAWriterThatWasKilledAtItsEnd) {
  {
    const auto owner = create();
    putGeneration(*owner, 0);
    put(*owner, "last", "1");
  }
  ::chmod(file_.c_str(), 0444);
  ::chmod(lockFile().c_str(), 0666);
  EXPECT_EQ(inChild([&] {
              becomeAnotherUser();
              const auto early = open(OpenMode::ReadOnly);
              const std::uint64_t newest = early->read().commitNumber();
              if (!forgetNewestCommit(file_, newest)) return 1;
              try {
                early->read();
                return 2;
              } catch (const LockFileOutdated& error) {
                if (std::string_view(error.what()).find("was killed") == std::string_view::npos) return 3;
              }
              const auto late = open(OpenMode::ReadOnly);
              if (late->read().commitNumber() != newest || late->read().block("t", "last") != "1") return 4;
              return late == open(OpenMode::ReadOnly) ? 0 : 5;
            }),
            0);
  ::chmod(file_.c_str(), 0644);
  put(*open(), "next", "2");
  EXPECT_EQ(open()->read().block("t", "last"), "1");
}

TEST_F(SharedMap, AReaderThatMayNotWriteTheLockFileReadsWhileAWriterIsAtWork) {
  putGeneration(*create(), 0);
  Talk talk;
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(60);
    int result = 97;
    talk.hearParent();
    becomeAnotherUser();
    try {
      const ReadTransaction transaction = open(OpenMode::ReadOnly)->read();
      result = readAll(transaction) + (transaction.block("t", "0")->front() == 'b' ? 0 : 2);
    } catch (const Error&) {
      result = 50;
    }
    ::_exit(result);
  }
  const auto owner = open();
  putGeneration(*owner, 1);
  WriteTransaction unfinished = owner->write();
  for (int i = 0; i < kBlocks; ++i) unfinished.putBlock("t", std::to_string(i), std::string(30'000, 'z'));
  takeRightToWrite();
  talk.tellChild();
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

/// Copies made beside quick commits are of one commit, or are refused.
TEST_F(SharedMap, ACopyMadeBesideCommitsIsOfOneCommit) {
  putGeneration(*create(), 0);
  Talk talk;
  const pid_t child = ::fork();
  if (child == 0) {
    becomeAnotherUser();
    talk.hearParent();
    int read = 0, torn = 0;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(100);
    for (int i = 0; (i < 40 || read == 0) && std::chrono::steady_clock::now() < end; ++i) {
      try {
        torn += readAll(open(OpenMode::ReadOnly)->read());
        ++read;
      } catch (const MapBusy&) {
      } catch (const Error&) {
        ++torn;
      }
    }
    ::_exit(torn > 0 ? 1 : read > 0 ? 0 : 2);
  }
  const auto owner = open();
  takeRightToWrite();
  talk.tellChild();
  int status = 0, generation = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    try {
      putGeneration(*owner, ++generation);
    } catch (const MapBusy&) {  // a copy was made under the lock
    }
  }
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_GT(generation, 5);
}

TEST_F(SharedMap, AReaderThatMayNotWriteTheMapMakesNoLockFile) {
  create().reset();
  fs::remove(lockFile());
  ::chmod(folder_.path().c_str(), 0777);
  takeRightToWrite();
  EXPECT_EQ(inChild([&] {
              becomeAnotherUser();
              return open(OpenMode::ReadOnly)->read().block("t", "x") ? 1 : 0;
            }),
            0);
  EXPECT_FALSE(fs::exists(lockFile()));
}

TEST_F(SharedMap, TheLockFileHasTheRightsOfTheMap) {
  create().reset();
  fs::remove(lockFile());
  ::chmod(file_.c_str(), 0664);
  const bool is_root = ::geteuid() == 0;
  if (is_root) {
    ASSERT_EQ(::chown(file_.c_str(), kNobody, kNobody), 0);
  }
  open(OpenMode::ReadOnly).reset();
  struct stat status {};
  ASSERT_EQ(::stat(lockFile().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0664U);
  if (is_root) {
    EXPECT_EQ(status.st_uid, kNobody);
    EXPECT_EQ(status.st_gid, kNobody);
  }
}

TEST_F(SharedMap, AForeignLockFileIsNamedToTheOwnerWhoWantsToWrite) {
  create().reset();
  takeRightToWrite();
  ::chmod(file_.c_str(), 0666);
  EXPECT_EQ(inChild([&] {
              becomeAnotherUser();
              const std::string message = refusal(OpenMode::ReadWrite);
              return message.find("map.clx-lock") != std::string::npos && message.find("remove it") != std::string::npos
                         ? 0
                         : 1;
            }),
            0);
}

/// The temporary folder often has less room than the map's.
TEST_F(SharedMap, ACopyTakesNoMoreRoomThanTheMap) {
  if (!hasHoles(folder_.path()) || !hasHoles(fs::temp_directory_path())) GTEST_SKIP() << "no holes here";
  {
    const auto owner = create();
    put(*owner, "long", std::string(8'000'000, 'a'));
    putGeneration(*owner, 1);
    put(*owner, "long", "b");
    ASSERT_GT(releaseFreePages(*owner), 7'000'000U);
  }
  const Descriptor map(::open(file_.c_str(), O_RDONLY | O_CLOEXEC));
  PrivateCopy copy(file_, map.get());
  EXPECT_EQ(fs::file_size(copy.file()), fs::file_size(file_));
  EXPECT_LT(diskBytes(copy.file()), diskBytes(file_) + 500'000);
  const ReadTransaction transaction = Environment::open(copy.file(), OpenMode::ReadOnly)->read();
  EXPECT_EQ(readAll(transaction), 0);
  EXPECT_EQ(transaction.block("t", "long"), "b");
}

/// The end of a file may be a hole, too.
TEST_F(SharedMap, ACopyIsAsLongAsTheMap) {
  putGeneration(*create(), 1);
  fs::resize_file(file_, fs::file_size(file_) + 3'000'000);
  const Descriptor map(::open(file_.c_str(), O_RDONLY | O_CLOEXEC));
  PrivateCopy copy(file_, map.get());
  EXPECT_EQ(fs::file_size(copy.file()), fs::file_size(file_));
}

TEST_F(SharedMap, ACopyServesTwiceWhileThereIsNoOtherCommit) {
  putGeneration(*create(), 0);
  takeRightToWrite();
  EXPECT_EQ(inChild([&] {
              becomeAnotherUser();
              const auto first = open(OpenMode::ReadOnly), again = open(OpenMode::ReadOnly);
              return first == again && readAll(first->read()) == 0 ? 0 : 1;
            }),
            0);
}

}  // namespace
}  // namespace cluxel::rdf
