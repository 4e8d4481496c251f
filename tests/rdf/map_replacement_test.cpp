// SPDX-License-Identifier: Apache-2.0
// Tests of replacing a map while other processes read it, open it or wait to write; of closed streams and full disks.
#include "rdf/file/map_replacement.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <optional>
#include <thread>
#include <vector>

#include "rdf/file/file_guards.hpp"
#include "rdf/file/opening/joint_use.hpp"
#include "rdf/map_file_fixture.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class MapReplacement : public MapFile {
 protected:
  /// A closed map whose block "n" holds its number of quads.
  fs::path fresh(int n) const {
    const fs::path file = folder_.path() / "fresh.clx";
    const auto environment = Environment::open(file, OpenMode::Create);
    for (int i = 1; i <= n; ++i) {
      WriteTransaction transaction = environment->write();
      QuadWriter writer(transaction);
      writer.add(QuadIds{static_cast<TermId>(i), 1, 1, 0});
      writer.flush();
      transaction.putBlock("t", "n", std::to_string(i));
      transaction.commit();
    }
    return file;
  }
  void replaceBy(int n) {
    const fs::path other = fresh(n);
    const WriteTransaction nobody_writes = writeMap(file_);
    replaceMapFile(other, file_);
  }
};

TEST_F(MapReplacement, LetsOldReadersGoOnAndLeavesNothingBeside) {
  fs::rename(fresh(1), file_);
  const auto old = open(OpenMode::ReadOnly);
  const ReadTransaction before = old->read();
  replaceBy(5);
  EXPECT_EQ(before.block("t", "n"), "1");
  EXPECT_EQ(old->read().block("t", "n"), "1");
  EXPECT_EQ(open()->read().block("t", "n"), "5");
  for (const auto& entry : fs::directory_iterator(folder_.path())) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name == "map.clx" || name == "map.clx-lock" || name == "fresh.clx-lock") << name;
  }
}

TEST_F(MapReplacement, TakesNothingFromWhoWaitedToWrite) {
  fs::rename(fresh(1), file_);
  int to_child[2], to_parent[2];
  ASSERT_EQ(::pipe(to_child) | ::pipe(to_parent), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    char byte = 'r';
    const WriteTransaction transaction = writeMap(file_);
    const fs::path copy = folder_.path() / "copy.clx";
    open()->compactTo(copy);
    if (::write(to_parent[1], &byte, 1) == 1 && ::read(to_child[0], &byte, 1) == 1) replaceMapFile(copy, file_);
    ::_exit(0);
  }
  char byte = 0;
  ASSERT_EQ(::read(to_parent[0], &byte, 1), 1);
  const auto waiting = open();
  ASSERT_EQ(::write(to_child[1], &byte, 1), 1);
  EXPECT_THROW(waiting->write(), MapReplaced) << "what it writes would go with the old file";
  {
    WriteTransaction transaction = writeMap(file_);
    transaction.putBlock("t", "late", "kept");
    transaction.commit();
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  const auto now = open(OpenMode::ReadOnly);
  EXPECT_NE(now, waiting);
  EXPECT_EQ(now->read().block("t", "late"), "kept");
  EXPECT_EQ(now->read().block("t", "n"), "1");
}

TEST_F(MapReplacement, IsToldToEachThreadThatWaitedToWrite) {
  fs::rename(fresh(1), file_);
  EXPECT_EQ(inChild([&] {
              ::alarm(20);
              const auto environment = open();
              std::optional<WriteTransaction> first = environment->write();
              std::atomic<int> told = 0;
              std::vector<std::thread> waiting;
              for (int i = 0; i < 3; ++i)
                waiting.emplace_back([&] {
                  try {
                    environment->write();
                  } catch (const MapReplaced&) {
                    ++told;
                  }
                });
              std::this_thread::sleep_for(std::chrono::milliseconds(200));
              fs::rename(file_, folder_.path() / "moved.clx");
              first.reset();
              for (std::thread& thread : waiting) thread.join();
              return told.load();
            }),
            3);
}

TEST_F(MapReplacement, NeverGivesAnOpenerTheLockFileOfTheOtherMap) {
  fs::rename(fresh(1), file_);
  const fs::path stop = folder_.path() / "stop";
  const pid_t child = ::fork();
  if (child == 0) {
    int torn = 0;
    while (!fs::exists(stop)) {
      try {
        const auto environment = Environment::open(file_, OpenMode::ReadOnly);
        const ReadTransaction transaction = environment->read();
        torn += transaction.block("t", "n") != std::to_string(QuadReader(transaction).size()) ? 1 : 0;
      } catch (...) {
        ++torn;
      }
    }
    ::_exit(std::min(torn, 100));
  }
  for (int round = 0; round < 25; ++round) replaceBy(1 + round % 7);
  std::ofstream(stop) << "stop";
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST_F(MapReplacement, ThatFailsNamesBothFilesAndKeepsThem) {
  const fs::path other = fresh(3);
  fs::create_directories(file_ / "full");
  try {
    replaceMapFile(other, file_);
    FAIL() << "a file took the place of a folder";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
    EXPECT_THAT(error.what(), HasSubstr("fresh.clx"));
    EXPECT_THAT(error.what(), HasSubstr("map.clx"));
  }
  EXPECT_EQ(Environment::open(other, OpenMode::ReadOnly)->read().block("t", "n"), "3");
}

TEST_F(MapReplacement, AMapAndALinkToItShareOneLockFile) {
  fs::rename(fresh(1), file_);
  fs::create_symlink("map.clx", folder_.path() / "link.clx");
  EXPECT_EQ(Environment::open(folder_.path() / "link.clx", OpenMode::ReadWrite)->file(), file_);
  EXPECT_TRUE(fs::exists(folder_.path() / "map.clx-lock"));
  EXPECT_FALSE(fs::exists(folder_.path() / "link.clx-lock"));
}

TEST_F(MapFile, NeverGetsADescriptorThatTextIsWrittenTo) {
  create().reset();
  const int result = inChild([&] {
    for (const int stream : {0, 1, 2}) ::close(stream);
    const auto environment = open();
    put(*environment, "a", "1");
    const std::string text(8192, '!');
    for (const int stream : {0, 1, 2})
      if (::write(stream, text.data(), text.size()) >= 0) return 1;
    put(*environment, "a", "2");
    return environment->read().block("t", "a") == "2" ? 0 : 2;
  });
  EXPECT_EQ(result, 0);
  EXPECT_EQ(open()->read().block("t", "a"), "2");
}

TEST_F(MapFile, HasALockFileWithoutHoles) {
  create().reset();
  struct stat status {};
  ASSERT_EQ(::stat((file_.string() + "-lock").c_str(), &status), 0);
  EXPECT_GT(status.st_size, 0);
  EXPECT_GE(status.st_blocks * 512, status.st_size);
}

constexpr int kNoDisk = 77;

/// Fills a disk completely.
void fill(const fs::path& file) {
  std::ofstream out(file, std::ios::binary);
  const std::string block(4096, 'x');
  while (out.write(block.data(), static_cast<std::streamsize>(block.size())).flush()) {
  }
}

/// Runs on a separate full disk. Returns 0, or the number of the failed check.
int useAFullDisk(const fs::path& disk) {
  const fs::path map = disk / "map.clx", copy = disk / "copy.clx";
  {
    const auto environment = Environment::open(map, OpenMode::Create);
    WriteTransaction transaction = environment->write();
    transaction.putBlock("t", "a", "kept");
    transaction.commit();
  }
  fs::remove(disk / "map.clx-lock");
  fill(disk / "filling");
  {
    const auto reading = Environment::open(map, OpenMode::ReadOnly);
    if (reading->read().block("t", "a") != "kept") return 1;
    try {
      reading->compactTo(copy);
      return 2;
    } catch (const Error& error) {
      if (std::string_view(error.what()).find("no space") == std::string_view::npos) return 3;
    }
    if (fs::exists(copy) || fs::exists(disk / "copy.clx-lock")) return 4;
  }
  try {
    Environment::open(map, OpenMode::ReadWrite);
  } catch (const Error& error) {
    return std::string_view(error.what()).find("no space is left") != std::string_view::npos ? 0 : 5;
  }
  return 6;
}

TEST_F(MapFile, OnAFullDiskIsReadAndRefusesToBeWritten) {
  const int result = inChild([&] {
    const fs::path disk = folder_.path() / "disk";
    fs::create_directory(disk);
    if (::unshare(CLONE_NEWNS) != 0 || ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        ::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=512k") != 0)
      return kNoDisk;
    return useAFullDisk(disk);
  });
  if (result == kNoDisk) GTEST_SKIP() << "a disk of one's own cannot be mounted here";
  EXPECT_EQ(result, 0);
}

/// File systems number their files alike. Returns 0, or the number of the failed check.
int useTwoLockFilesOfOneNumber(const fs::path& folder) {
  for (const char* disk : {"a", "b"}) {
    fs::create_directory(folder / disk);
    if (::mount("tmpfs", (folder / disk).c_str(), "tmpfs", 0, "size=64k") != 0) return kNoDisk;
    std::ofstream(folder / disk / "first") << "map";
    std::ofstream(folder / disk / "second") << "lock file";
  }
  const auto opened = [&](const char* file) { return Descriptor(::open((folder / file).c_str(), O_RDWR | O_CLOEXEC)); };
  const Descriptor map = opened("a/first"), again = opened("a/first");
  Descriptor lock = opened("a/second"), same = opened("a/second"), other = opened("b/second");
  if (identityOf(lock.get(), "a").inode != identityOf(other.get(), "b").inode) return kNoDisk;
  const JointUse use(map.get(), std::move(lock));
  if (const JointUse with_same(again.get(), std::move(same)); use.hasOtherLockFiles()) return 1;
  const JointUse with_other(again.get(), std::move(other));
  return use.hasOtherLockFiles() ? 0 : 2;
}

TEST_F(MapFile, TellsLockFilesOfTwoFileSystemsApart) {
  const int result = inChild([&] {
    if (::unshare(CLONE_NEWNS) != 0 || ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return kNoDisk;
    return useTwoLockFilesOfOneNumber(folder_.path());
  });
  if (result == kNoDisk) GTEST_SKIP() << "a disk of one's own cannot be mounted here";
  EXPECT_EQ(result, 0);
}

}  // namespace
}  // namespace cluxel::rdf
