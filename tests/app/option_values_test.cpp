// SPDX-License-Identifier: Apache-2.0
// Values of options: all commands refuse the same values, and say what is wrong in the same words.
#include <algorithm>
#include <sstream>

#include "app/program_fixture.hpp"

namespace cluxel::app {

using namespace rdf;
namespace {

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream all(text);
  for (std::string line; std::getline(all, line);) lines.push_back(line);
  return lines;
}

/// An option that takes a number, and its command.
struct NumberOption {
  std::string command, name;
  bool is_whole;
};

/// As `--help` shows the options of a command and of its subcommands.
void addNumberOptions(const std::string& help, const std::string& command, std::vector<NumberOption>& all) {
  for (const std::string& line : linesOf(help)) {
    std::istringstream words(line);
    std::string name, type;
    words >> name >> type;
    if (!line.starts_with("  ") || !name.starts_with("--")) continue;
    const std::string kind = type.substr(0, type.find(':'));
    if (kind == "FLOAT" || kind == "UINT" || kind == "INT") all.push_back({command, name, kind != "FLOAT"});
  }
}

std::vector<std::string> subcommandsOf(const std::string& help) {
  std::vector<std::string> names;
  bool is_listed = false;
  for (const std::string& line : linesOf(help)) {
    if (line.starts_with("Subcommands:"))
      is_listed = true;
    else if (!line.starts_with("  "))
      is_listed = false;
    else if (is_listed && line[2] != ' ')
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return names;
}

class OptionValues : public Program {
 protected:
  static void SetUpTestSuite() { folder = new ScratchFolder; }

  static void addOptionsBelow(const std::string& command, std::vector<NumberOption>& all) {
    const Outcome help = run(command + " --help");
    ASSERT_EQ(help.code, 0) << command;
    addNumberOptions(help.out, command, all);
    for (const std::string& name : subcommandsOf(help.out)) addOptionsBelow(command + " " + name, all);
  }
};

TEST_F(OptionValues, ThatAreNoNumbersAreRefusedByEveryOptionThatTakesOne) {
  std::vector<NumberOption> options;
  addOptionsBelow("", options);
  const auto has = [&](const std::string& name) {
    return std::any_of(options.begin(), options.end(), [&](const NumberOption& one) { return one.name == name; });
  };
  for (const char* name : {"--threads", "--view", "--width", "--idle", "--deadline", "--size", "--batch-points"})
    EXPECT_TRUE(has(name)) << name;
  for (const NumberOption& option : options) {
    for (const char* value : {"nan", "-inf", "5m", "''"}) {
      SCOPED_TRACE(option.command + " " + option.name + " " + value);
      const Outcome outcome = run(option.command + " " + option.name + "=" + value);
      expectError(outcome, 2, option.name + ": ");
      EXPECT_EQ(outcome.err.find("Could not convert"), std::string::npos) << outcome.err;
    }
    if (option.is_whole) expectError(run(option.command + " " + option.name + "=1e3"), 2, "write a whole number");
    if (option.is_whole) expectError(run(option.command + " " + option.name + "=010"), 2, "write a whole number");
  }
}

TEST_F(OptionValues, ThatAreWrongAreNamedWithWhatTheOptionTakes) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"explain map.clx 1 --why-not ''", "--why-not: the value is empty"},
      {"state map.clx --object 1 --is ''", "--is: the value is empty"},
      {"extend map.clx ''", "scans: the value is empty"},
      {"extend '' s", "map: the value is empty"},
      {"rules apply map.clx --rules ''", "--rules: the value is empty"},
      {"changes map.clx --since ''", "--since: the value is empty"},
      {"search map.clx --for Tree --view nan", "search: --view: write a number from 1 to 100, not nan"},
      {"search map.clx --for Tree --view 0", "--view: write a number from 1 to 100, not 0"},
      {"search map.clx --for Tree --stops 0", "--stops: write a whole number from 1 to 100, not 0"},
      {"search map.clx --for Tree --budget abc", "--budget: 'abc' is no number"},
      {"search map.clx --for Tree --width -1", "--width: write a number from 0 to 20, not -1"},
      {"search map.clx --for Tree --detection 2", "--detection: write a number from 0 to 1, not 2"},
      {"search learn map.clx", "search learn: --output is required"},
      {"rules test --least-score 2", "--least-score: write a number from 0 to 1, not 2"},
      {"route map.clx 0,0 5,5 --cell 0.3", "--cell: '0.3' is none of 0.125, 0.25, 0.5, 1"},
      {"route map.clx 0,0 5,5 --cell nan", "--cell: 'nan' is none of 0.125, 0.25, 0.5, 1"},
      {"route map.clx 0,0 5,5 --format xml", "--format: 'xml' is none of geojson"},
      {"ask map.clx objects --format xml", "--format: 'xml' is none of table, csv, json, geojson"},
      {"serve map.clx --deadline nan", "--deadline: write a number from 0.001 to 1000000000, not nan"},
      {"query map.clx objects --deadline inf", "--deadline: write a number above 0, not inf"},
      {"query map.clx objects --max-memory 1.5", "--max-memory: write a whole number above 0, not 1.5"},
      {"build s -o x.clx --units parsec", "--units: 'parsec' is none of cm, ft, m, mm, us-ft"},
      {"build s -o x.clx --units 1", "--units: '1' is none of cm, ft, m, mm, us-ft"},
      {"build s -o x.clx --up x", "--up: 'x' is none of y, z"},
      {"extend x.clx s --batch-points 1e3", "--batch-points: write a whole number above 0, not 1e3"},
      {"simulate s --laser velodyne", "--laser: 'velodyne' is none of pan-tilt, spinning"},
      {"simulate s --size 100m", "--size: '100m' is no number"},
      {"simulate s --size 401", "--size: write a number from 45 to 400, not 401"},
      {"state map.clx --ignore-region 0,0,nan,5", "--ignore-region: write a number that is finite, not nan"},
      {"state map.clx --ignore-region 0,0,5m,5", "--ignore-region: '5m' is no number"},
      {"tasks --threads -3", "--threads: write a whole number from 0 to 1024, not -3"},
      {"tasks --threads 1025", "--threads: write a whole number from 0 to 1024, not 1025"}};
  for (const auto& [arguments, words] : cases) {
    SCOPED_TRACE(arguments);
    const Outcome outcome = run(arguments);
    expectError(outcome, 2, words + "\n");
    EXPECT_EQ(outcome.err.find("a command is missing"), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace cluxel::app
