// SPDX-License-Identifier: Apache-2.0
// The search order of data folders.
#include "cluxel/base/data_home.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel {
namespace {

namespace fs = std::filesystem;

class DataHomes : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "cluxel_home_XXXXXX").string();
    folder_ = mkdtemp(name.data());
    for (const char* home : {"a", "b"}) fs::create_directories(folder_ / home / "rules");
    std::ofstream(folder_ / "b" / "rules" / "outdoor.yaml") << "b";
  }
  void TearDown() override {
    unsetenv("CLUXEL_HOME");
    fs::remove_all(folder_);
  }
  fs::path folder_;
};

TEST_F(DataHomes, GiveTheFirstPlaceThatHasTheFile) {
  const DataHome home({folder_ / "a", folder_ / "b"});
  EXPECT_EQ(home.locate("rules/outdoor.yaml"), folder_ / "b" / "rules" / "outdoor.yaml");
  std::ofstream(folder_ / "a" / "rules" / "outdoor.yaml") << "a";
  EXPECT_EQ(home.locate("rules/outdoor.yaml"), folder_ / "a" / "rules" / "outdoor.yaml");
}

TEST_F(DataHomes, TakeANameThatExistsAsItIs) {
  const fs::path own = folder_ / "b" / "rules" / "outdoor.yaml";
  const DataHome home({folder_ / "a"});
  EXPECT_EQ(home.locate("rules", own), own);
  EXPECT_EQ(DataHome({folder_ / "b"}).locate("rules", "outdoor.yaml"), own);
}

TEST_F(DataHomes, ListThePlacesLookedAt) {
  try {
    DataHome({folder_ / "a", folder_ / "b"}).locate("rules/absent.yaml");
    FAIL() << "nothing was refused";
  } catch (const Error& e) {
    const std::string text = e.what();
    EXPECT_EQ(e.code(), ExitCode::FaultyInput);
    EXPECT_NE(text.find((folder_ / "a" / "rules" / "absent.yaml").string()), std::string::npos);
    EXPECT_NE(text.find((folder_ / "b" / "rules" / "absent.yaml").string()), std::string::npos);
    EXPECT_NE(text.find("--home"), std::string::npos);
  }
}

TEST_F(DataHomes, PreferTheOptionThenTheVariableThenTheWorkingFolder) {
  setenv("CLUXEL_HOME", (folder_ / "b").c_str(), 1);
  const auto roots = DataHome::find(folder_ / "a").roots();
  ASSERT_GE(roots.size(), 3U);
  EXPECT_EQ(roots[0], folder_ / "a");
  EXPECT_EQ(roots[1], folder_ / "b");
  EXPECT_EQ(roots[2], fs::current_path());
  unsetenv("CLUXEL_HOME");
  EXPECT_EQ(DataHome::find().roots().at(0), fs::current_path());
}

TEST_F(DataHomes, LookBesideTheExecutableAndAboveIt) {
  const auto roots = DataHome::find().roots();
  const fs::path beside = fs::read_symlink("/proc/self/exe").parent_path();
  EXPECT_NE(std::find(roots.begin(), roots.end(), beside), roots.end());
  EXPECT_NE(std::find(roots.begin(), roots.end(), beside.parent_path()), roots.end());
}

}  // namespace
}  // namespace cluxel
