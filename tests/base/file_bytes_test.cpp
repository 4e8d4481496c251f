// SPDX-License-Identifier: Apache-2.0
// Files are written whole or not at all.
#include "cluxel/base/file_bytes.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

#include "cluxel/base/diagnostic.hpp"

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
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  writeFile(folder_ / "a", "old");
  fs::create_symlink("/dev/full", folder_ / "a.partial");
  EXPECT_THROW(writeFile(folder_ / "a", std::string(100'000, 'x')), Error);
  EXPECT_EQ(readFile(folder_ / "a"), "old");
  EXPECT_EQ(filesThere(), 1U);
}

TEST_F(FileBytes, NameTheFileThatCannotBeWritten) {
  try {
    writeFile(folder_ / "absent" / "a", "x");
    FAIL() << "nothing was refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::StoreUnavailable);
    EXPECT_NE(std::string(e.what()).find((folder_ / "absent" / "a").string() + ": cannot be written"),
              std::string::npos);
  }
}

TEST_F(FileBytes, LeaveNoPartWhenTheyCannotBeMovedIntoPlace) {
  fs::create_directories(folder_ / "a" / "full");
  EXPECT_THROW(writeFile(folder_ / "a", "x"), Error);
  EXPECT_EQ(filesThere(), 1U);
}

}  // namespace
}  // namespace cluxel
