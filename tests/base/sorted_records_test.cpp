// SPDX-License-Identifier: Apache-2.0
// Records sorted with little memory, against a set; full and absent disks.
#include "base/sorting/sorted_records.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <random>
#include <set>

#include "base/temporary_folder.hpp"
#include "cluxel/error.hpp"

namespace cluxel {
namespace {

namespace fs = std::filesystem;

/// Names a new folder as the one for temporary files.
class SortedInFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "cluxel_sorting_XXXXXX").string();
    folder_ = mkdtemp(name.data());
    used_.emplace(folder_);
  }
  void TearDown() override {
    used_.reset();
    fs::remove_all(folder_);
  }
  fs::path folder_;
  std::optional<TemporaryFolderIs> used_;
};

std::string randomRecord(std::mt19937& random) {
  std::string record;
  for (std::size_t count = random() % 12; count > 0; --count) record += "ab\0\xff"[random() % 4];
  if (random() % 50 == 0) record += std::string(random() % 6000, 'x');
  return record;
}

/// The message of a failure, or that there was none.
template <typename Work>
std::string failureOf(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.kind() == ErrorKind::StoreUnavailable ? error.what() : "another kind";
  }
  return "no failure";
}

void addMany(SortedRecords& records) {
  for (int i = 0; i < 10'000; ++i) records.add(std::to_string(i * 7919 % 10'007) + std::string(100, 'x'));
}

TEST_F(SortedInFolder, RecordsComeInOrderOnceWhateverFitsIntoMemory) {
  std::mt19937 random(3);
  for (const std::size_t limit : {std::size_t{1}, std::size_t{500}, std::size_t{20'000}, SortedRecords::kUsualBytes}) {
    SortedRecords records(limit);
    for (int round = 0; round < 5; ++round) {  // it is used again and again
      std::set<std::string> expected;
      for (std::size_t count = random() % 1000; count > 0; --count) {
        const std::string record = randomRecord(random);
        records.add(record);
        expected.insert(record);
      }
      std::vector<std::string> sorted;
      records.drain([&](std::string_view record) { sorted.emplace_back(record); });
      ASSERT_EQ(sorted, std::vector<std::string>(expected.begin(), expected.end())) << limit << ", round " << round;
    }
  }
}

TEST_F(SortedInFolder, LeaveNoFileThatAKilledProcessWouldForget) {
  SortedRecords records(1000);
  addMany(records);
  EXPECT_TRUE(fs::is_empty(folder_));
  records.drain([&](std::string_view) { ASSERT_TRUE(fs::is_empty(folder_)); });
}

TEST_F(SortedInFolder, TellThatTheDiskIsFull) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100'000, 100'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    SortedRecords records(1000);
    const std::string failure = failureOf([&] { addMany(records); });
    const bool names_folder = failure.starts_with(folder_.string() + ": a temporary file cannot be written");
    ::_exit(names_folder && failure.find("set TMPDIR") != std::string::npos ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(SortedInFolder, NeedTheFolderOnlyForWhatDoesNotFitIntoMemory) {
  const TemporaryFolderIs none("/there/is/none");
  SortedRecords in_memory, in_file(1000);
  EXPECT_EQ(failureOf([&] { addMany(in_memory), in_memory.drain([](std::string_view) {}); }), "no failure");
  EXPECT_NE(failureOf([&] { addMany(in_file); }).find("/there/is/none"), std::string::npos);
}

}  // namespace
}  // namespace cluxel
