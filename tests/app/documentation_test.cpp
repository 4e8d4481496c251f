// SPDX-License-Identifier: Apache-2.0
// The man page and shell completion hold every command, and the tools that read them accept them.
#include <sstream>

#include "app/program_fixture.hpp"

namespace cluxel::app {
namespace {

const std::vector<std::string> kCommands{"info",     "simulate",  "register", "build",   "extend",  "retract", "repose",
                                         "merge",    "query",     "update",   "tasks",   "explain", "rules",   "train",
                                         "evaluate", "export",    "serve",    "compact", "doctor",  "route",   "reach",
                                         "costmap",  "search",    "view",     "load",    "dump",    "changes", "watch",
                                         "ask",      "inventory", "state"};

bool hasTool(const std::string& tool) {
  return std::system(("command -v " + tool + " > /dev/null").c_str()) == 0;
}

class Documentation : public Program {
 protected:
  static std::string written(const std::string& option) {
    const Outcome outcome = run("documentation " + option);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    writeFile(path("documentation"), outcome.out);
    return outcome.out;
  }
  static Outcome shell(const std::string& command) {
    const int status = std::system((command + " > " + path("out").string() + " 2> " + path("err").string()).c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readFile(path("out")), readFile(path("err"))};
  }
  /// What bash offers for the last of the words.
  static std::vector<std::string> completed(const std::string& words) {
    written("--completion bash");
    writeFile(path("complete.sh"), "source " + path("documentation").string() + "\nCOMP_WORDS=(" + words +
                                       ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_cluxel\n"
                                       "printf '%s\\n' \"${COMPREPLY[@]}\"\n");
    const Outcome outcome = shell("bash " + path("complete.sh").string());
    EXPECT_EQ(outcome.err, "");
    std::istringstream lines(outcome.out);
    std::vector<std::string> offered;
    for (std::string line; std::getline(lines, line);)
      if (!line.empty()) offered.push_back(line);
    return offered;
  }
};

TEST_F(Documentation, TheManPageHoldsEveryCommandAndManReadsItWithoutWarnings) {
  const std::string page = written("--man");
  for (const std::string& command : kCommands) EXPECT_NE(page.find("cluxel " + command), std::string::npos) << command;
  EXPECT_NE(page.find("cluxel rules check"), std::string::npos);
  EXPECT_NE(page.find("EXIT STATUS"), std::string::npos);
  EXPECT_EQ(page.find("cluxel documentation"), std::string::npos) << "it is hidden";
  if (!hasTool("man") || !hasTool("groff")) GTEST_SKIP() << "no man here";
  const Outcome shown =
      shell("MANROFFSEQ= MANWIDTH=100 LC_ALL=C.UTF-8 man -l --warnings " + path("documentation").string());
  EXPECT_EQ(shown.code, 0);
  EXPECT_EQ(shown.err, "");
  EXPECT_NE(shown.out.find("--batch-points"), std::string::npos);
}

TEST_F(Documentation, TheScriptsAreAcceptedByTheirShells) {
  for (const std::string name : {"bash", "zsh", "fish"}) {
    const std::string script = written("--completion " + name);
    for (const std::string& command : kCommands) EXPECT_NE(script.find(command), std::string::npos) << name << command;
    if (!hasTool(name)) continue;
    const Outcome checked = shell(name + " -n " + path("documentation").string());
    EXPECT_EQ(checked.code, 0) << name << ": " << checked.err;
  }
}

TEST_F(Documentation, BashCompletesCommandsAndOptions) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(completed("cluxel qu"), Words{"query"});
  EXPECT_EQ(completed("cluxel ''").size(), kCommands.size());
  EXPECT_EQ(completed("cluxel rules ''"), (Words{"check", "test", "apply", "try", "diff", "fit", "teach", "doc"}));
  EXPECT_EQ(completed("cluxel build --batch"), Words{"--batch-points"});
  EXPECT_EQ(completed("cluxel rules test --ju"), Words{"--junit"});
  EXPECT_EQ(completed("cluxel --home query bui"), Words{"build"}) << "the word behind --home is a folder";
  EXPECT_EQ(completed("cluxel query --thr"), Words{"--threads"}) << "options of the program stand behind commands too";
  EXPECT_EQ(completed("cluxel build scans"), Words{}) << "bash completes files then";
}

TEST_F(Documentation, AnUnknownShellIsAnErrorOfUsage) {
  expectError(run("documentation --completion tcsh"), 2, "bash, zsh or fish");
  expectError(run("documentation"), 2, "--man");
}

TEST_F(Documentation, TheVersionNamesCommitAndFormats) {
  const std::string version = run("--version").out;
  for (const char* part : {"cluxel ", "(commit ", "map format ", "stages ", "features "})
    EXPECT_NE(version.find(part), std::string::npos) << version;
}

}  // namespace
}  // namespace cluxel::app
