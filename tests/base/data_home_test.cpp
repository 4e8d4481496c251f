// SPDX-License-Identifier: Apache-2.0
// The one home of the data folders, and what a name in it means.
#include "base/installation/data_home.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "cluxel/error.hpp"
#include "test_paths.hpp"

namespace cluxel {
namespace {

namespace fs = std::filesystem;

class DataHomes : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "cluxel_home_XXXXXX").string();
    folder_ = fs::canonical(mkdtemp(name.data()));
    working_folder_ = fs::current_path();
    for (const char* home : {"a", "b"}) fs::create_directories(folder_ / home / "rules");
    std::ofstream(folder_ / "b" / "rules" / "outdoor.yaml") << "b";
  }
  void TearDown() override {
    unsetenv("CLUXEL_HOME");
    fs::current_path(working_folder_);
    fs::remove_all(folder_);
  }
  void add(const fs::path& file) const {
    fs::create_directories((folder_ / file).parent_path());
    std::ofstream(folder_ / file) << "x";
  }
  fs::path folder_, working_folder_;
};

TEST_F(DataHomes, GiveTheFileInTheHome) {
  EXPECT_EQ(DataHome(folder_ / "b").locate("rules/outdoor.yaml"), folder_ / "b" / "rules" / "outdoor.yaml");
  EXPECT_EQ(DataHome(folder_ / "b").locate("rules", "outdoor.yaml"), folder_ / "b" / "rules" / "outdoor.yaml");
}

TEST_F(DataHomes, TakeAPathThatExistsAsItIs) {
  const fs::path own = folder_ / "b" / "rules" / "outdoor.yaml";
  EXPECT_EQ(DataHome(folder_ / "a").locate("rules", own), own);
  EXPECT_EQ(DataHome(folder_ / "a").locate("rules", folder_ / "b"), folder_ / "b");
}

TEST_F(DataHomes, NameThePlaceLookedAtAndTheRemedy) {
  try {
    DataHome(folder_ / "a").locate("rules/absent.yaml");
    FAIL() << "nothing was refused";
  } catch (const Error& e) {
    const std::string text = e.what();
    EXPECT_EQ(e.kind(), ErrorKind::FaultyInput);
    EXPECT_NE(text.find((folder_ / "a" / "rules" / "absent.yaml").string()), std::string::npos);
    EXPECT_EQ(e.remedy(), Remedy::NameHome);
  }
  EXPECT_THROW(DataHome(fs::path()).locate("rules"), Error);
}

TEST_F(DataHomes, TellWhereANameWasLookedForAndWhichOneIsNearest) {
  fs::current_path(folder_);
  add("mine.rules.yaml");
  const DataHome home(folder_ / "b");
  const auto refusalOf = [&](const fs::path& name) {
    try {
      home.locate("rules", name);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string places =
      "' was not found; looked in the working directory and in " + (folder_ / "b" / "rules").string();
  EXPECT_EQ(refusalOf("outdor.yaml"), "'outdor.yaml" + places + "\n  hint: did you mean 'outdoor.yaml'?");
  EXPECT_EQ(refusalOf("outdoor"), "'outdoor" + places + "\n  hint: did you mean 'outdoor.yaml'?");
  EXPECT_EQ(refusalOf("mine.rule.yaml"), "'mine.rule.yaml" + places + "\n  hint: did you mean 'mine.rules.yaml'?");
  EXPECT_EQ(refusalOf("indeed.yaml"), "'indeed.yaml" + places + "\n  hint: known: outdoor.yaml");
  EXPECT_EQ(refusalOf("indeed.rq"), "'indeed.rq" + places);
  EXPECT_EQ(refusalOf("b/rules/outdor.yaml"),
            "'b/rules/outdor.yaml" + places + "\n  hint: did you mean 'b/rules/outdoor.yaml'?");
  EXPECT_EQ(refusalOf("./indeed.yaml"), "'./indeed.yaml" + places);
  EXPECT_EQ(refusalOf("/nowhere/outdoor.yaml"), "'/nowhere/outdoor.yaml' was not found");
}

TEST_F(DataHomes, AreTheOptionThenTheVariableThenTheCheckoutOfTheProgram) {
  setenv("CLUXEL_HOME", (folder_ / "b").c_str(), 1);
  EXPECT_EQ(DataHome::find(folder_ / "a").root(), folder_ / "a");
  EXPECT_EQ(DataHome::find().root(), folder_ / "b");
  unsetenv("CLUXEL_HOME");
  EXPECT_EQ(DataHome::find().root(), fs::canonical(test::sourceFolder()));
}

TEST_F(DataHomes, AreNotSearchedInTheWorkingFolder) {
  for (const char* file : {"CMakeLists.txt", "ontology/core.ttl", "share/cluxel/ontology/core.ttl"}) add(file);
  fs::current_path(folder_);
  EXPECT_EQ(DataHome::find().root(), fs::canonical(test::sourceFolder()));
}

TEST_F(DataHomes, HideFoldersOfTheWorkingFolderButNotItsFiles) {
  add("b/models/oakland/model.json");
  add("oakland/scan.pcd");
  add("mine/model.json");
  add("outdoor.yaml");
  fs::current_path(folder_);
  const DataHome home(folder_ / "b");
  EXPECT_EQ(home.locate("models", "oakland"), folder_ / "b" / "models" / "oakland");
  EXPECT_EQ(home.locate("models", "./oakland"), "./oakland");
  EXPECT_EQ(home.locate("models", "mine"), "mine");
  EXPECT_EQ(home.locate("rules", "outdoor.yaml"), "outdoor.yaml");
}

TEST_F(DataHomes, LieInTheSharedFolderOfAnInstallation) {
  add("share/cluxel/ontology/core.ttl");
  const fs::path share = folder_ / "share" / "cluxel";
  EXPECT_EQ(dataHomeOf(folder_ / "bin" / "cluxel"), share);
  EXPECT_EQ(dataHomeOf(folder_ / "lib" / "libcluxel.so.0"), share);
  EXPECT_EQ(dataHomeOf(folder_ / "lib" / "x86_64-linux-gnu" / "libcluxel.so.0"), share);
}

TEST_F(DataHomes, LieInTheCheckoutAroundABuild) {
  const fs::path program = folder_ / "build" / "release" / "tests" / "test_base";
  EXPECT_EQ(dataHomeOf(program), fs::path());
  for (const char* file : {"CMakeLists.txt", "ontology/core.ttl"}) add(file);
  EXPECT_EQ(dataHomeOf(program), folder_);
}

}  // namespace
}  // namespace cluxel
