// SPDX-License-Identifier: Apache-2.0
// Files are written whole or not at all.
#include "base/file_bytes.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "base/file_pieces.hpp"
#include "base/temporary_folder.hpp"
#include "cluxel/error.hpp"

namespace cluxel {
namespace {

namespace fs = std::filesystem;

class FileBytes : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "cluxel_files_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::size_t filesThere() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
};

TEST_F(FileBytes, ComeBackUnchanged) {
  std::string bytes;
  for (int i = 0; i < 200'000; ++i) bytes += static_cast<char>(i * 7);
  for (const std::string& content : {std::string(), std::string("\0\n\r", 3), bytes}) {
    writeFile(folder_ / "a", content);
    EXPECT_EQ(readFile(folder_ / "a"), content);
  }
  EXPECT_EQ(filesThere(), 1U);
}

TEST_F(FileBytes, RefuseFoldersAndAbsentFilesByName) {
  const auto refusal = [](const fs::path& path) {
    try {
      readFile(path);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("nothing was refused");
  };
  EXPECT_EQ(refusal(folder_), folder_.string() + ": error: is a folder, a file was expected");
  EXPECT_EQ(refusal(folder_ / "absent"),
            (folder_ / "absent").string() + ": error: cannot be opened: No such file or directory");
}

TEST_F(FileBytes, LeaveTheOldFileWhenTheDiskIsFull) {
  writeFile(folder_ / "a", "old");
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      writeFile(folder_ / "a", std::string(100'000, 'x'));
    } catch (const Error& error) {
      ::_exit(error.kind() == ErrorKind::StoreUnavailable ? 0 : 1);
    }
    ::_exit(2);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(readFile(folder_ / "a"), "old");
  EXPECT_EQ(filesThere(), 1U);
}

TEST_F(FileBytes, HaveNoNameUntilTheyAreWhole) {
  writeFile(folder_ / "a", "old");
  ::chmod((folder_ / "a").c_str(), 0640);
  writeFileInPieces(folder_ / "a", [&](const auto& take) {
    take("first ");
    EXPECT_EQ(filesThere(), 1U) << "whoever is killed here leaves a file";
    take("second");
    EXPECT_EQ(readFile(folder_ / "a"), "old");
  });
  EXPECT_EQ(readFile(folder_ / "a"), "first second");
  EXPECT_EQ(filesThere(), 1U);
  struct stat now {};
  ASSERT_EQ(::stat((folder_ / "a").c_str(), &now), 0);
  EXPECT_EQ(now.st_mode & 07777U, 0640U);
}

TEST_F(FileBytes, OfTheUserAreNotOverwrittenWhateverTheirNames) {
  for (const char* name : {"a.partial", "a.tmp", "a~"}) std::ofstream(folder_ / name) << "mine";
  writeFile(folder_ / "a", "new");
  for (const char* name : {"a.partial", "a.tmp", "a~"}) EXPECT_EQ(readFile(folder_ / name), "mine") << name;
  EXPECT_EQ(filesThere(), 4U);
}

TEST_F(FileBytes, GoThroughALinkWhichStays) {
  fs::create_directory(folder_ / "far");
  fs::create_symlink("far/b", folder_ / "a");
  fs::create_symlink("a", folder_ / "z");
  for (const char* text : {"first: the link leads to nothing", "second"}) {
    writeFile(folder_ / "z", text);
    EXPECT_EQ(readFile(folder_ / "far/b"), text);
  }
  EXPECT_TRUE(fs::is_symlink(folder_ / "a") && fs::is_symlink(folder_ / "z"));
  EXPECT_EQ(withoutLinks(folder_ / "z"), folder_ / "far/b");
  EXPECT_EQ(withoutLinks(folder_ / "far"), folder_ / "far");
}

TEST_F(FileBytes, AreWrittenIntoAPipeThatIsThere) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { std::getline(std::ifstream(pipe), read); });
  writeFile(pipe, "through the pipe");
  reader.join();
  EXPECT_EQ(read, "through the pipe");
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(filesThere(), 1U);
}

/// A name that is too long, as a folder that may not be entered, does not let us see what is there.
TEST_F(FileBytes, OfWhatCannotBeLookedAtMayBeThere) {
  const fs::path refused = folder_ / std::string(300, 'x');
  EXPECT_TRUE(mayBeThere(refused));
  EXPECT_FALSE(mayBeThere(folder_ / "absent"));
  EXPECT_TRUE(mayBeThere(folder_));
  for (const fs::path& folder : {refused, folder_ / "absent"}) EXPECT_THROW(filesIn(folder, {".x"}), InputError);
}

TEST_F(FileBytes, BeginAsTheWholeFileDoes) {
  writeFile(folder_ / "a", "0123456789");
  EXPECT_EQ(readBeginning(folder_ / "a", 4), "0123");
  EXPECT_EQ(readBeginning(folder_ / "a", 40), "0123456789");
  EXPECT_THROW(readBeginning(folder_ / "absent", 4), InputError);
  EXPECT_THROW(readBeginning(folder_, 4), InputError);
}

/// Opening a pipe that nobody writes to waits for ever.
TEST_F(FileBytes, OfANamedPipeOrADeviceAreRefused) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink(pipe, folder_ / "link");
  EXPECT_THROW(readFile(pipe), InputError);
  EXPECT_THROW(readFile(folder_ / "link"), InputError);
  EXPECT_THROW(readFile("/dev/zero"), InputError);
}

/// As the shell does for <(command).
TEST_F(FileBytes, OfAPipeThatIsOpenAreRead) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ASSERT_EQ(::write(ends[1], "through", 7), 7);
  ::close(ends[1]);
  EXPECT_EQ(readFile("/dev/fd/" + std::to_string(ends[0])), "through");
  ::close(ends[0]);
}

TEST_F(FileBytes, AreWrittenToADeviceThatStaysOne) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  fs::create_symlink("/dev/null", folder_ / "nothing");
  writeFile(folder_ / "nothing", "x");
  EXPECT_TRUE(fs::is_symlink(folder_ / "nothing") && fs::is_character_file("/dev/null"));
  fs::create_symlink("/dev/full", folder_ / "full");
  EXPECT_THROW(writeFile(folder_ / "full", "x"), Error);
}

TEST_F(FileBytes, KeepTheRightsOfTheFileThatTheyReplace) {
  writeFile(folder_ / "a", "secret");
  fs::permissions(folder_ / "a", fs::perms::owner_read | fs::perms::owner_write);
  writeFile(folder_ / "a", "secret still");
  EXPECT_EQ(fs::status(folder_ / "a").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(FileBytes, NameTheFileThatCannotBeWritten) {
  try {
    writeFile(folder_ / "absent" / "a", "x");
    FAIL() << "nothing was refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::StoreUnavailable);
    EXPECT_NE(std::string(e.what()).find((folder_ / "absent" / "a").string() + ": cannot be written"),
              std::string::npos);
  }
}

TEST_F(FileBytes, LeaveNoPartWhenTheyCannotBeMovedIntoPlace) {
  fs::create_directories(folder_ / "a" / "full");
  EXPECT_THROW(writeFile(folder_ / "a", "x"), Error);
  EXPECT_EQ(filesThere(), 1U);
}

TEST(TemporaryFolderPath, IsToldWhenItIsNone) {
  {
    const TemporaryFolderIs none("/there/is/none");
    try {
      temporaryFolderPath();
      ADD_FAILURE() << "there is no such folder";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
      EXPECT_NE(std::string(error.what()).find("/there/is/none"), std::string::npos) << error.what();
    }
  }
  EXPECT_TRUE(std::filesystem::is_directory(temporaryFolderPath()));
}

}  // namespace
}  // namespace cluxel
