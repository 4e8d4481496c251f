// SPDX-License-Identifier: Apache-2.0
// Large arrays hold what vectors hold, and are in files.
#include "base/sorting/large_array.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include "base/file_bytes.hpp"
#include "base/temporary_folder.hpp"
#include "cluxel/error.hpp"

namespace cluxel {
namespace {

constexpr std::size_t kFew = kMostBytesInMemory / sizeof(std::uint32_t), kMany = kFew + 1000;

/// The anonymous memory of this process [bytes].
std::size_t anonymousMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (std::size_t kilobytes = 0; word == "RssAnon:" && status >> kilobytes) return kilobytes * 1024;
  return 0;
}

TEST(LargeArray, HoldsWhatAVectorHoldsWhileItGrowsAndIsCopied) {
  std::vector<std::uint32_t> expected;
  LargeArray<std::uint32_t> array;
  for (std::uint32_t i = 0; i < kMany; ++i) expected.push_back(i * 2654435761U), array.push_back(i * 2654435761U);
  EXPECT_TRUE(std::equal(array.begin(), array.end(), expected.begin(), expected.end()));
  LargeArray<std::uint32_t> copy = array;
  copy[7] = 1;
  EXPECT_EQ(array[7], expected[7]) << "a copy is another file";
  const LargeArray<std::uint32_t> moved = std::move(copy);
  EXPECT_EQ(moved[7], 1U);
  EXPECT_EQ(moved[kMany - 1], expected[kMany - 1]);
}

TEST(LargeArray, TakesNoAnonymousMemory) {
  const std::size_t before = anonymousMemory();
  const LargeArray<std::uint32_t> array(4 * kMany, 5U);
  EXPECT_LT(anonymousMemory(), before + kMostBytesInMemory);
  EXPECT_EQ(std::accumulate(array.begin(), array.end(), std::uint64_t{0}), std::uint64_t{20} * kMany);
}

TEST(LargeArray, NeedsTheFolderForTemporaryFilesOnlyWhenItIsLarge) {
  const TemporaryFolderIs none("/there/is/none");
  EXPECT_NO_THROW(LargeArray<std::uint32_t>(kFew, 0U));
  try {
    const LargeArray<std::uint32_t> array(kMany, 0U);
    ADD_FAILURE() << "there is no folder";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
    EXPECT_NE(std::string(error.what()).find("/there/is/none"), std::string::npos);
    EXPECT_EQ(std::string(error.what()).find("room"), std::string::npos) << "room would not help";
  }
}

/// What a child process that may not write files of more than a megabyte is told by an array of more.
std::string toldWhereFilesAreLimited(bool is_signal_ignored) {
  int ends[2];
  if (::pipe(ends) != 0) return "no pipe";
  const pid_t child = ::fork();
  if (child == 0) {
    if (is_signal_ignored) ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1'000'000, 1'000'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    std::string told = "nothing";
    try {
      const LargeArray<std::uint32_t> array(kMany, 0U);
    } catch (const Error& error) {
      told = error.kind() == ErrorKind::StoreUnavailable ? error.what() : "another kind";
    }
    const bool is_written = ::write(ends[1], told.data(), told.size()) == static_cast<ssize_t>(told.size());
    ::_exit(is_written ? 0 : 1);
  }
  ::close(ends[1]);
  std::string told(4096, ' ');
  told.resize(static_cast<std::size_t>(std::max<ssize_t>(0, ::read(ends[0], told.data(), told.size()))));
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  return status == 0 ? told : "the process ended otherwise";
}

TEST(LargeArray, TellsThatNoFileMayBeAsLarge) {
  const std::string expected = temporaryFolderPath().string() +
                               ": a temporary file cannot be enlarged (File too large); allow larger files (ulimit "
                               "-f), or set TMPDIR to a folder that can hold them";
  EXPECT_EQ(toldWhereFilesAreLimited(true), expected);
  EXPECT_EQ(toldWhereFilesAreLimited(false), expected) << "the signal would end the process";
}

}  // namespace
}  // namespace cluxel
