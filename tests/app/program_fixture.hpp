// SPDX-License-Identifier: Apache-2.0
// Runs the program as a user would, on a small generated campus and a map of it.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "base/file_bytes.hpp"
#include "rdf/scratch_folder.hpp"
#include "test_paths.hpp"

namespace cluxel::app {

using namespace rdf;

namespace fs = std::filesystem;

struct Outcome {
  int code = -1;
  std::string out, err;
};

class Program : public testing::Test {
 public:
  static fs::path path(const std::string& name) { return folder->path() / name; }

 protected:
  static void SetUpTestSuite() {
    folder = new ScratchFolder;
    writeFile(path("three.ttl"), "@prefix e: <https://e.org/> .\ne:a e:p 1 . e:b e:p 2 . e:c e:p 3 .\n");
    const Outcome campus =
        run("simulate " + path("campus").string() + " --stops 2 --size 50 --points-per-stop 3000 --json");
    simulated = campus.out;
    built = run("build " + path("campus").string() + " -o " + path("map.clx").string() + " --json");
  }
  static void TearDownTestSuite() { delete folder; }

  /// The program with the checkout's data, to be followed by arguments.
  static std::string program() {
    return (test::buildFolder() / "cluxel").string() + " --home " + test::sourceFolder().string() + " --threads 1 ";
  }
  /// `to`: where stdout goes, when not into the outcome.
  static Outcome run(const std::string& arguments, const std::string& to = "") {
    const std::string err = path("stderr").string(), out = to.empty() ? path("stdout").string() : to;
    const std::string command = program() + arguments + " > " + out + " 2> " + err;
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, to.empty() ? readFile(out) : "", readFile(err)};
  }
  static Outcome query(const std::string& source, const std::string& text, const std::string& more = "") {
    return run("query " + path(source).string() + " -e '" + text + "' " + more);
  }
  static inline ScratchFolder* folder = nullptr;
  static inline std::string simulated;
  static inline Outcome built;
};

inline void expectError(const Outcome& outcome, int code, const std::string& words) {
  EXPECT_EQ(outcome.code, code) << outcome.err;
  EXPECT_EQ(outcome.out, "") << "errors go to stderr";
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
}

}  // namespace cluxel::app
