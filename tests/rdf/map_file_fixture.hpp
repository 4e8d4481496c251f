// SPDX-License-Identifier: Apache-2.0
// A map file in a temporary folder, and functions that run in child processes.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <string>

#include "cluxel/error.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/scratch_folder.hpp"

namespace cluxel::rdf {

class MapFile : public testing::Test {
 protected:
  std::shared_ptr<Environment> create() { return Environment::open(file_, OpenMode::Create); }
  std::shared_ptr<Environment> open(OpenMode mode = OpenMode::ReadWrite) { return Environment::open(file_, mode); }

  static void put(Environment& environment, std::string_view key, std::string_view bytes) {
    WriteTransaction transaction = environment.write();
    transaction.putBlock("t", key, bytes);
    transaction.commit();
  }

  std::string refusal(OpenMode mode = OpenMode::ReadOnly) {
    try {
      open(mode);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
      EXPECT_THAT(error.what(), testing::HasSubstr("map.clx"));
      return error.what();
    }
    return "opened";
  }

  static std::string refusalOf(const std::function<void()>& work) {
    try {
      work();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
      return error.what();
    }
    return "no refusal";
  }

  /// Runs `work` in a child process. Returns its exit status, or the negative number of the signal that ended it.
  template <typename Work>
  static int inChild(const Work& work) {
    const pid_t child = ::fork();
    if (child == 0) {
      int result = 99;
      try {
        result = work();
      } catch (const Error& error) {
        result = 50 + static_cast<int>(error.kind());
      } catch (...) {
      }
      ::_exit(result);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  }

  ScratchFolder folder_;
  std::filesystem::path file_ = folder_.path() / "map.clx";
};

}  // namespace cluxel::rdf
