// SPDX-License-Identifier: Apache-2.0
// The man page and shell completion hold every command, and the tools that read them accept them.
#include <map>
#include <regex>
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

/// The options that a command's help lists, each with its short form or an empty text.
std::map<std::string, std::string> optionsIn(const std::string& help) {
  static const std::regex kOption("^ +(-[a-z])?,?(--[a-z][a-z0-9-]*)");
  std::map<std::string, std::string> options;
  std::istringstream lines(help);
  std::smatch found;
  for (std::string line; std::getline(lines, line);)
    if (std::regex_search(line, found, kOption)) options[found[2]] = found[1];
  return options;
}

/// The text of docs/cli.md before its first section and in the section whose heading names the command.
class CommandLineDocument {
 public:
  CommandLineDocument() {
    std::istringstream lines(readFile(test::sourceFolder() / "docs" / "cli.md"));
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("## ")) sections_.push_back({line, ""});
      (sections_.empty() ? intro_ : sections_.back().text) += line + '\n';
    }
  }
  bool hasSection(const std::string& command) const { return !textOf(command).empty(); }
  /// An option may be written in its short form, and those of many commands stand before the sections.
  bool names(const std::string& command, const std::string& option, const std::string& short_form) const {
    return hasWord(textOf(command), option) || hasWord(intro_, option) ||
           (!short_form.empty() && hasWord(textOf(command), short_form));
  }

 private:
  struct Section {
    std::string heading, text;
  };
  std::string textOf(const std::string& command) const {
    for (const Section& section : sections_)
      if (std::regex_search(section.heading, std::regex("(^## |, )" + command + "( |,|$)"))) return section.text;
    return {};
  }
  static bool hasWord(const std::string& text, const std::string& word) {
    return std::regex_search(text, std::regex("(^|[^-a-z])" + word + "($|[^-a-z])"));
  }

  std::string intro_;
  std::vector<Section> sections_;
};

TEST_F(Documentation, NamesEachOptionInTheSectionOfItsCommand) {
  const CommandLineDocument document;
  std::vector<std::pair<std::string, std::string>> commands;  // with the heading of their section
  for (const std::string& command : kCommands)
    if (command != "rules") commands.emplace_back(command, command);
  for (const char* command : {"check", "test", "apply", "try", "diff", "fit", "teach", "doc"})
    commands.emplace_back("rules " + std::string(command), "rules " + std::string(command));
  commands.emplace_back("search learn", "search");
  for (const auto& [command, heading] : commands) {
    EXPECT_TRUE(document.hasSection(heading)) << "docs/cli.md has no section for " << command;
    const auto options = optionsIn(run(command + " --help").out);
    EXPECT_TRUE(options.contains("--help")) << command;
    for (const auto& [option, short_form] : options) {
      const bool is_named = option == "--help" || document.names(heading, option, short_form);
      EXPECT_TRUE(is_named) << "docs/cli.md, " << command << ": " << option;
    }
  }
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
