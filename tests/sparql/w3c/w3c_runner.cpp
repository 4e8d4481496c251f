// SPDX-License-Identifier: Apache-2.0
// Runs the W3C SPARQL suites and prints a table: w3c_runner [FOLDER] [--only TEXT] [--program FILE] [--every N]. With
// --program all is done by starting the program. --every N runs each N-th test, but all of them where the environment
// holds CLUXEL_LONG_TESTS. Exit code 77: the suites are absent.
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>

#include "cluxel/error.hpp"
#include "rdf/scratch_folder.hpp"
#include "sparql/w3c/w3c_case.hpp"
#include "test_paths.hpp"

namespace {

using namespace cluxel::test;

struct Options {
  std::filesystem::path folder = cluxel::test::sourceFolder() / "../shared/w3c/sparql";
  std::string only;               ///< run the tests whose id contains it
  std::filesystem::path program;  ///< empty: the engine within this process
  std::size_t every = 1;
};

Options optionsOf(int argc, char** argv) {
  Options options;
  if (const char* folder = std::getenv("CLUXEL_W3C")) options.folder = folder;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--only" && i + 1 < argc)
      options.only = argv[++i];
    else if (std::string(argv[i]) == "--program" && i + 1 < argc)
      options.program = argv[++i];
    else if (std::string(argv[i]) == "--every" && i + 1 < argc)
      options.every = std::stoul(argv[++i]);
    else
      options.folder = argv[i];
  }
  if (options.every == 0 || std::getenv("CLUXEL_LONG_TESTS") != nullptr) options.every = 1;
  return options;
}

/// Lines "id  reason"; # begins a comment.
std::map<std::string, std::string> knownFailures() {
  std::map<std::string, std::string> known;
  std::ifstream file(cluxel::test::sourceFolder() / "tests/sparql/w3c/w3c_known.txt");
  for (std::string line; std::getline(file, line);) {
    const std::size_t space = line.find(' ');
    if (line.empty() || line[0] == '#' || space == std::string::npos) continue;
    known[line.substr(0, space)] = line.substr(line.find_first_not_of(' ', space));
  }
  return known;
}

std::vector<W3cCase> allCases(const W3cFolder& folder) {
  std::vector<W3cCase> cases;
  for (const char* manifest :
       {"sparql10/manifest-syntax.ttl", "sparql10/manifest-evaluation.ttl", "sparql11/manifest-sparql11-query.ttl",
        "sparql11/manifest-sparql11-update.ttl", "sparql11/manifest-sparql11-results.ttl"})
    for (W3cCase& test : readManifest(folder, manifest)) cases.push_back(std::move(test));
  return cases;
}

struct Tally {
  int passed = 0, failed = 0;
};

void printTable(const std::map<std::string, Tally>& groups) {
  std::cout << "\n"
            << std::left << std::setw(36) << "group" << std::right << std::setw(8) << "passed" << std::setw(8)
            << "failed"
            << "\n";
  for (const auto& [group, tally] : groups)
    std::cout << std::left << std::setw(36) << group << std::right << std::setw(8) << tally.passed << std::setw(8)
              << tally.failed << "\n";
}

int runAll(const Options& options) {
  std::cout << std::unitbuf;  // a crash must not swallow what was found before
  const W3cFolder folder(std::filesystem::canonical(options.folder));
  const std::map<std::string, std::string> known = knownFailures();
  std::map<std::string, Tally> groups;
  Tally total;
  int surprises = 0;
  const cluxel::rdf::ScratchFolder scratch;
  std::size_t number = 0;
  for (const W3cCase& test : allCases(folder)) {
    if (test.id.find(options.only) == std::string::npos || number++ % options.every != 0) continue;
    const std::string fault = options.program.empty() ? runCase(folder, test)
                                                      : runCaseByProgram(options.program, scratch.path(), folder, test);
    const auto listed = known.find(test.id);
    const bool as_known = fault.empty() == (listed == known.end());
    surprises += as_known ? 0 : 1;
    ++(fault.empty() ? groups[test.group].passed : groups[test.group].failed);
    ++(fault.empty() ? total.passed : total.failed);
    if (!fault.empty())
      std::cout << "FAILED " << test.id << (as_known ? " (known: " + listed->second + ")" : "\n" + fault) << "\n";
    else if (!as_known)
      std::cout << "PASSED " << test.id << ", though w3c_known.txt lists it\n";
  }
  printTable(groups);
  std::cout << total.passed << " passed, " << total.failed << " failed\n";
  return surprises == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  constexpr int skipped = 77;
  const Options options = optionsOf(argc, argv);
  if (!std::filesystem::exists(options.folder / "sparql10")) {
    std::cout << "outside data absent: the W3C suites, looked for in " << options.folder.string() << "\n";
    return skipped;
  }
  try {
    return runAll(options);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
