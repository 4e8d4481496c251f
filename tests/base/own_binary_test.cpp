// SPDX-License-Identifier: Apache-2.0
// Where modules are looked for, and which ones are refused.
#include "base/installation/own_binary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "cluxel/error.hpp"

namespace cluxel {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ModuleOf : public testing::Test {
 protected:
  ModuleOf() { fs::remove_all(folder_); }
  ~ModuleOf() override { fs::remove_all(folder_); }

  fs::path write(const fs::path& relative) const {
    fs::create_directories((folder_ / relative).parent_path());
    std::ofstream(folder_ / relative) << "x";
    return folder_ / relative;
  }

  static std::string refusalOf(const fs::path& binary) {
    try {
      return "found " + moduleOf(binary, "m.so").string();
    } catch (const Error& error) {
      return error.what();
    }
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("modules_" + std::to_string(getpid()));
};

TEST_F(ModuleOf, FindsItInTheInstallation) {
  const fs::path module = write(fs::path("prefix") / CLUXEL_LIBRARY_FOLDER / "cluxel/m.so");
  EXPECT_EQ(moduleOf(write("prefix/bin/program"), "m.so"), module);
  EXPECT_EQ(moduleOf(write(fs::path("prefix") / CLUXEL_LIBRARY_FOLDER / "library.so"), "m.so"), module);
}

TEST_F(ModuleOf, FindsItInTheBuildFolder) {
  const fs::path module = write("build/modules/m.so");
  EXPECT_EQ(moduleOf(write("build/program"), "m.so"), module);
  EXPECT_EQ(moduleOf(write("build/tests/fuzz/test"), "m.so"), module);
}

TEST_F(ModuleOf, NamesTheProgramThatHasNone) {
  write("modules/m.so");
  const fs::path far = write("a/b/c/d/program");
  EXPECT_THAT(refusalOf(far), testing::AllOf(HasSubstr("'m.so' was not found around '" + far.string()),
                                             HasSubstr("link to the program instead of copying it")));
}

/// A file of root as the program, and a module of somebody else.
TEST_F(ModuleOf, RefusesOneOfAnotherUser) {
  const fs::path module = write("build/modules/m.so"), program = folder_ / "build/program";
  fs::create_symlink("/usr/bin/env", program);
  if (getuid() == 0) {
    EXPECT_EQ(moduleOf(program, "m.so"), module);
    ASSERT_EQ(chown(module.c_str(), 4711, 4711), 0);
  }
  EXPECT_THAT(refusalOf(program), HasSubstr("belongs to another user than '" + program.string()));
}

}  // namespace
}  // namespace cluxel
