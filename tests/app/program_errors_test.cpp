// SPDX-License-Identifier: Apache-2.0
// Errors on the command line: each kind has one exit code in every command, and says what, where and what to do.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "app/program_fixture.hpp"
#include "test_paths.hpp"

namespace cluxel::app {

using namespace rdf;
namespace {

std::string campus() {
  return Program::path("campus").string();
}
std::string map() {
  return Program::path("map.clx").string();
}
std::string fresh() {
  return Program::path("never.clx").string();
}

TEST_F(Program, AMapThatIsNotThereIsExitCodeFiveInEveryCommand) {
  const std::string absent = path("absent.clx").string();
  for (const std::string& arguments : std::vector<std::string>{
           "info " + absent, "query " + absent + " -e 'ASK {}'", "update " + absent + " -e 'CLEAR ALL'",
           "explain " + absent + " 1234", "state " + absent + " --list",
           "evaluate " + absent + " --truth " + campus() + "/truth", "export " + absent + " --canonical",
           "view " + absent + " -o " + fresh(), "compact " + absent, "compact " + absent + " -o " + fresh(),
           "doctor " + absent, "rules check --map " + absent}) {
    SCOPED_TRACE(arguments);
    expectError(run(arguments), 5, "absent.clx");
    EXPECT_FALSE(fs::exists(absent));
    EXPECT_FALSE(fs::exists(fresh()));
  }
}

TEST_F(Program, WhatIsNoMapIsExitCodeFiveInEveryCommandThatNeedsOne) {
  const std::string text = path("no-map.clx").string();
  writeFile(text, std::string(20'000, 'x'));
  for (const std::string& arguments : std::vector<std::string>{
           "info " + text, "query " + text + " -e 'ASK {}'", "update " + text + " -e 'CLEAR ALL'",
           "explain " + text + " 1234", "state " + text + " --list", "rules check --map " + text,
           "rules try " + text + " outdoor.rules.yaml", "rules diff " + text + " outdoor.rules.yaml outdoor.rules.yaml",
           "evaluate " + text + " --truth " + campus() + "/truth", "export " + text + " --canonical",
           "view " + text + " -o " + fresh(), "compact " + text, "query " + campus() + " -e 'ASK {}'",
           "compact " + campus(), "doctor " + campus()}) {
    SCOPED_TRACE(arguments);
    expectError(run(arguments), 5, "map");
  }
  EXPECT_EQ(run("doctor " + text).code, 1) << "doctor answers whether the file is a sound map";
}

TEST_F(Program, ANamedPipeInPlaceOfAMapIsExitCodeFive) {
  const std::string pipe = path("pipe.clx").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0666), 0);
  const int end = ::open(pipe.c_str(), O_RDWR | O_CLOEXEC);  // who opens the pipe does not wait
  for (const std::string command : {"info ", "doctor ", "compact "}) {
    SCOPED_TRACE(command);
    expectError(run(command + pipe), 5, "is a pipe or a device");
  }
  ::close(end);
}

TEST_F(Program, AnyOtherInputThatIsNotThereIsExitCodeFourInEveryCommand) {
  for (const std::string& arguments :
       std::vector<std::string>{"info absent-input",
                                "build absent-input -o " + fresh(),
                                "build " + campus() + " -o " + fresh() + " --poses absent-input",
                                "build " + campus() + " -o " + fresh() + " --model absent-input",
                                "build " + campus() + " -o " + fresh() + " --rules absent-input",
                                "build " + campus() + " -o " + fresh() + " --sparql-rules absent-input",
                                "build " + campus() + " -o " + fresh() + " --ontology absent-input",
                                "query absent-input.ttl -e 'ASK {}'",
                                "query " + map() + " absent-input.rq",
                                "update " + map() + " absent-input.ru",
                                "evaluate " + map() + " --truth absent-input",
                                "rules check absent-input",
                                "rules check --ontology absent-input",
                                "rules test absent-input",
                                "rules try " + map() + " absent-input",
                                "rules diff " + map() + " outdoor.rules.yaml absent-input",
                                "inventory " + map() + " --streets absent-input.geojson",
                                "inventory " + map() + " --register absent-input.csv",
                                "search " + map() + " --for Tree --from 0,0 --places absent-input.ttl",
                                "train absent-input --truth campus -o " + fresh(),
                                "train " + campus() + " --truth absent-input -o " + fresh()}) {
    SCOPED_TRACE(arguments);
    expectError(run(arguments), 4, "absent-input");
    EXPECT_FALSE(fs::exists(fresh()));
  }
}

TEST_F(Program, TryingRulesTellsByItsExitCodeWhetherSomethingDiffers) {
  const Outcome same = run("rules try " + map() + " outdoor.rules.yaml");
  EXPECT_EQ(same.code, 0) << same.out << same.err;
  EXPECT_NE(same.out.find("no difference"), std::string::npos);
  writeFile(path("other.rules.yaml"),
            "apiVersion: cluxel.rules/v1\ninclude: [ " + (test::sourceFolder() / "rules/outdoor.rules.yaml").string() +
                " ]\noverride:\n  rules:\n    - { id: ground/patches, tree: { reject: off } }\n");
  const std::string before = readFile(map());
  const Outcome other = run("rules diff " + map() + " outdoor.rules.yaml " + path("other.rules.yaml").string() +
                            " --json --ply " + path("changes.ply").string());
  EXPECT_EQ(other.code, 1) << other.out << other.err;
  EXPECT_NE(other.out.find("\"Ground\""), std::string::npos);
  EXPECT_TRUE(readFile(path("changes.ply")).starts_with("ply\n"));
  EXPECT_EQ(readFile(map()), before) << "the map is not changed";
  expectError(run("rules try " + map() + " outdoor.rules.yaml --ply " + map()), 5, "is a map");
}

TEST_F(Program, CheckingRulesWarnsOfLabelsThatClassesShare) {
  writeFile(path("twins.ttl"),
            "@prefix owl: <http://www.w3.org/2002/07/owl#> . @prefix my: <http://x/> .\n"
            "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n"
            "my:A a owl:Class ; rdfs:label \"Doppelt\"@en . my:B a owl:Class ; rdfs:label \"Doppelt\"@de .\n");
  const Outcome outcome = run("rules check --ontology " + path("twins.ttl").string());
  EXPECT_NE(outcome.out.find("warning: the label 'Doppelt' is that of 2 classes"), std::string::npos) << outcome.out;
}

TEST_F(Program, CheckingRulesLooksIntoQueries) {
  writeFile(path("bad.rq"),
            "PREFIX clx: <https://w3id.org/cluxel/ontology#>\nCONSTRUCT { ?x a clx:Tree } WHERE { ?x a clx:Tre }\n");
  const Outcome outcome = run("rules check " + path("bad.rq").string());
  EXPECT_EQ(outcome.code, 4);
  EXPECT_NE(outcome.out.find("bad.rq:2:"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("did you mean 'Tree'?"), std::string::npos);
  writeFile(path("tab.rules.yaml"), "apiVersion: cluxel.rules/v1\nrules:\n\t- id: a\n");
  EXPECT_NE(run("rules check " + path("tab.rules.yaml").string()).out.find("indent with spaces"), std::string::npos);
  writeFile(path("brace.rules.yaml"), "apiVersion: cluxel.rules/v1\nprefixes: { clx: \"urn:x#\"\norder: [clx:Tree]\n");
  EXPECT_NE(run("rules check " + path("brace.rules.yaml").string()).out.find("is not closed"), std::string::npos);
  // All rules of a folder, with the faults of each.
  fs::create_directory(path("of_one"));
  for (const char* name : {"bad.rq", "tab.rules.yaml"}) fs::copy_file(path(name), path("of_one") / name);
  const Outcome folder = run("rules check " + path("of_one").string());
  EXPECT_EQ(folder.code, 4);
  for (const char* name : {"bad.rq", "tab.rules.yaml"})
    EXPECT_NE(folder.out.find(name), std::string::npos) << folder.out;
  fs::create_directory(path("of_none"));
  expectError(run("rules check " + path("of_none").string()), 2, "holds no *.rules.yaml and no *.rq");
}

TEST_F(Program, ExplainsWhyNotAndDrawsTrees) {
  const Outcome why = run("explain " + map() + " '#0' --why-not Tree");
  EXPECT_EQ(why.code, 0) << why.err;
  EXPECT_NE(why.out.find("why not clx:Tree:"), std::string::npos);
  EXPECT_TRUE(run("explain " + map() + " '#0' --dot").out.starts_with("digraph"));
  expectError(run("explain " + map() + " '#0' --why-not Tre"), 3, "Tree");
  const std::string rules = (test::sourceFolder() / "rules/outdoor.rules.yaml").string();
  expectError(run("rules apply " + map() + " --dry-run --rules " + rules + " " + rules), 2, "is named twice");
  expectError(run("explain " + map() + " map/root"), 3, "is a Map, neither an object nor a primitive");
  expectError(run("explain " + map() + " '#0' --dot --json"), 2, "--dot");
}

TEST_F(Program, APageNeedsAnOutputThatIsNoMap) {
  expectError(run("view " + map() + " -o " + map()), 5, "is a map");
  expectError(run("view " + map()), 2, "--output");
}

TEST_F(Program, AnUnknownCommandIsNamedWithTheNearestAndTheList) {
  expectError(run("qeury x"), 2, "there is no command 'qeury'; did you mean 'query'?");
  expectError(
      run("qeury x"), 2,
      "info, simulate, register, build, extend, retract, repose, merge, watch, query, state, update, load, dump, ask, "
      "tasks, explain, rules, train, evaluate, export, route, reach, costmap, search, inventory, changes, serve, view, "
      "compact, doctor");
  expectError(run("rules tset"), 2, "rules: there is no command 'tset'; did you mean 'test'?");
  expectError(run("rules"), 2, "rules: a command is missing: check, test, apply");
  expectError(run(""), 2, "a command is missing: info");
  expectError(run("frobnicate"), 2, "there is no command 'frobnicate'\n");
  expectError(run("next-view x"), 2, "'next-view' is a task, no command: 'cluxel ask MAP next-view'");
}

TEST_F(Program, AnUnknownOptionIsNamedWithTheNearest) {
  expectError(run("query " + map() + " objects --fromat csv"), 2,
              "query: there is no option '--fromat'; did you mean '--format'?");
  expectError(run("export --cannonical " + map()), 2, "did you mean '--canonical'?");
  expectError(run("query --frmat=csv"), 2, "'--frmat'");
  expectError(run("doctor " + map() + " --jsn"), 2, "did you mean '--json'?");
  expectError(run("tasks --thread 2"), 2, "did you mean '--threads'?");
  expectError(run("--json doctor " + map()), 2, "the option '--json' belongs after the command");
  expectError(run("doctor " + map() + " another.clx"), 2, "doctor: 'another.clx' is one argument too many");
}

TEST_F(Program, WhatIsMissingOrOutOfRangeIsNamedAndHelpIsPointedTo) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"build " + campus(), "--output"},
      {"build -o " + fresh(), "scans"},
      {"query", "source"},
      {"explain " + map(), "object"},
      {"evaluate " + map(), "--truth"},
      {"train " + campus() + " -o " + fresh(), "--truth"},
      {"query " + map() + " objects --deadline soon", "--deadline"},
      {"query " + map() + " objects --deadline -1", "--deadline"},
      {"query " + map() + " objects --max-rows -1", "--max-rows"},
      {"query " + map() + " objects --max-memory 0", "--max-memory"},
      {"simulate " + fresh() + " --size 10", "--size"},
      {"simulate " + fresh() + " --seed many", "--seed"},
      {"simulate " + fresh() + " --city 3", "COLUMNSxROWS"},
      {"simulate " + fresh() + " --city 3x0", "0 rows"},
      {"simulate " + fresh() + " --city 2x2 --districts 3", "FIRST..LAST"},
      {"simulate " + fresh() + " --city 2x2 --districts 3..4", "numbered 0..3"},
      {"simulate " + fresh() + " --districts 0..1", "--city"},
      {"build " + campus() + " -o " + fresh() + " --batch-points 0", "--batch-points"},
      {"evaluate " + map() + " --truth " + campus() + "/truth --min-oa 80", "--min-oa"},
      {"evaluate " + map() + " --truth " + campus() + "/truth --min-recall Tree", "CLASS=SHARE"},
      {"evaluate " + map() + " --truth " + campus() + "/truth --min-recall Tree=2", "CLASS=SHARE"},
      {"evaluate " + map() + " --truth " + campus() + "/truth --min-oa nan", "--min-oa"},
      {"simulate " + fresh() + " --seed -1", "--seed"},
      {"simulate " + fresh() + " --seed 18446744073709551616", "--seed"},
      {"tasks --threads -3", "--threads"},
      {"tasks --home " + path("nowhere").string(), "--home"}};
  for (const auto& [arguments, words] : cases) {
    SCOPED_TRACE(arguments);
    expectError(run(arguments), 2, words);
    EXPECT_FALSE(fs::exists(fresh()));
  }
  EXPECT_NE(run("query").err.find("hint: 'cluxel query --help'"), std::string::npos);
}

/// An unset shell variable gives an empty name. It must not mean the working directory, whose files would be replaced.
TEST_F(Program, AnEmptyNameOfWhatIsWrittenIsAnErrorOfUsage) {
  for (const std::string& arguments :
       std::vector<std::string>{"simulate '' --stops 1", "build " + campus() + " -o ''",
                                "export " + map() + " --canonical -o ''", "compact " + map() + " -o ''",
                                "register " + campus() + " -o ''", "train " + campus() + " --truth campus -o ''"}) {
    SCOPED_TRACE(arguments);
    expectError(run(arguments), 2, "the name is empty");
  }
}

TEST_F(Program, AQueryIsReadFromAFileOfAnyName) {
  writeFile(path("three"), "ASK { ?s ?p 3 }");
  EXPECT_EQ(run("query " + path("three.ttl").string() + " " + path("three").string()).out, "yes\n");
  EXPECT_EQ(run("query " + path("three.ttl").string() + " /dev/stdin < " + path("three").string()).out, "yes\n");
  expectError(run("query " + path("three.ttl").string() + " " + path("").string()), 4, "was not found");
}

TEST_F(Program, WrongChoicesOfOneCommandAreErrorsOfUsage) {
  expectError(run("export " + map() + " --format docx"), 2, "docx");
  expectError(run("export " + map() + " -o " + path("map.docx").string()), 2, "docx");
  expectError(run("export " + map()), 2, "--format");
  expectError(run("query " + map() + " objects -e 'ASK {}'"), 2, "not both");
  expectError(run("query " + map() + " objects --param far=1"), 2, "has no parameters");
  expectError(run("query " + map() + " near_point --param radius=far"), 2, "a number from 0 is expected [m]");
  expectError(run("query " + map() + " near_point --param raduis=3"), 2, "did you mean 'radius'?");
  expectError(run("query " + map() + " near_point --param radius=-3"), 2, "a number from 0 is expected [m]");
  expectError(run("ask " + map() + " near_point radius=-3"), 2, "write a number [m] from 0, not '-3'");
  expectError(run("ask " + map() + " uncertain_objects below=1.5"), 2, "from 0 to 1");
  expectError(run("query " + map() + " objects --format turtle"), 2, "choose table");
  expectError(run("explain " + map() + " abc"), 2, "four digits");
  expectError(run("export " + map() + " --format geojson"), 2, "hint: --local");
  expectError(run("update " + map()), 2, "-e TEXT");
  expectError(run("info " + map() + " " + campus()), 2, "map.clx");
  expectError(run("evaluate " + map() + " --truth " + campus() + "/truth --min-recall Unicorn=0.5"), 2, "Unicorn");
  expectError(run("train " + campus() + " --truth campus -o " + fresh() + " --helper " + campus()), 2,
              "--helper-truth");
  expectError(run("train " + campus() + " --truth campus -o " + fresh() + " --helper " + campus() + " --helper " +
                  campus() + " --helper " + campus() + " --helper-truth campus --helper-truth campus"),
              2, "one for each");
  expectError(run("simulate " + campus()), 2, "campus");
  for (const char* place : {"nan,0", "0,inf"})
    expectError(run("route " + map() + " " + place + " 5,5"), 2, "write a place as X,Y in metres");
  expectError(run("changes " + map() + " --since nan"), 2, "'nan' is no time");
}

TEST_F(Program, ErrorsOfTheLibraryAreShownWithTheOptionThatHelps) {
  expectError(run("build " + campus() + " -o " + map()), 2, "is a finished map\n  hint: --force replaces it");
  expectError(query("three.ttl", "SELECT * { SERVICE <https://e.org/> { ?s ?p ?o } }"), 4, "hint: --service IRI=FILE");
  expectError(run("query " + map() + " near_point --param raduis=3"), 2, "hint: --param NAME=VALUE");
  expectError(run("ask " + map() + " changes"), 2, "since=TIME");
}

TEST_F(Program, AThingThatIsNotInTheMapIsExitCodeThree) {
  expectError(run("explain " + map() + " ffffffffffffffff"), 3, "ffffffffffffffff");
  expectError(run("explain " + map() + " '#100000'"), 3, "#100000");
  expectError(run("explain " + map() + " https://w3id.org/cluxel/map/object/nothing"), 3, "nothing");
}

TEST_F(Program, OutputThatCannotBeWrittenIsExitCodeFive) {
  const std::string nowhere = path("nowhere/out").string();
  expectError(run("export " + map() + " --canonical -o " + nowhere), 5, "nowhere/out");
  expectError(run("compact " + map() + " -o " + nowhere), 5, "nowhere/out");
  expectError(run("compact " + map() + " -o " + path("three.ttl").string()), 5, "is there already");
  expectError(run("build " + campus() + " -o " + nowhere + ".clx"), 5, "nowhere/out.clx");
  expectError(run("build " + campus() + " -o " + campus()), 5, "is a folder");
  expectError(run("train " + campus() + " --truth campus -o " + map()), 5, "is a file");
  EXPECT_FALSE(fs::exists(path("nowhere")));
}

TEST_F(Program, AFullDiskIsNotTakenForSuccess) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  for (const std::string& arguments :
       std::vector<std::string>{"export --canonical " + map(), "query " + map() + " objects", "tasks --json"}) {
    const Outcome outcome = run(arguments, "/dev/full");
    EXPECT_EQ(outcome.code, 5) << arguments;
    EXPECT_NE(outcome.err.find("stdout"), std::string::npos) << outcome.err;
  }
}

TEST_F(Program, ClosedStreamsAreNotTakenForTheMap) {
  const std::string closed = path("closed.clx").string();
  fs::copy_file(map(), closed);
  const auto runClosed = [](const std::string& arguments) {
    const int status = std::system((program() + arguments).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  const std::string update = "update " + closed + " -e 'INSERT DATA { <https://e.org/a> a <https://e.org/b> }'";
  const std::string build = "build " + campus() + " -o " + closed + " --force";
  EXPECT_EQ(runClosed(update + " >&- 2>&-"), 5) << "its report is lost, and that is said";
  EXPECT_EQ(run("doctor " + closed).code, 0);
  EXPECT_EQ(runClosed(update + " <&- 2>&- > /dev/null"), 0);
  EXPECT_EQ(run("doctor " + closed).code, 0);
  EXPECT_EQ(runClosed(build + " 2>&- > /dev/null"), 0);
  EXPECT_EQ(runClosed(build + " >&- 2>&-"), 5);
  EXPECT_EQ(run("doctor " + closed).code, 0);
  EXPECT_EQ(run("info " + closed).code, 0);
}

TEST_F(Program, ABudgetBeyondAllNumbersIsNone) {
  for (const char* option :
       {"--deadline 1e300", "--deadline 1e12", "--max-memory 18446744073709551615", "--max-rows 18446744073709551615"})
    EXPECT_EQ(run("query " + path("three.ttl").string() + " -e 'ASK { ?s ?p 3 }' " + option).code, 0) << option;
}

TEST_F(Program, AReaderThatGoesAwayIsNoError) {
  const std::string command = std::string("bash -c 'set -o pipefail; ") + (test::buildFolder() / "cluxel").string() +
                              " export --canonical " + map() + " | head -1 > /dev/null'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST_F(Program, FaultsOfDamagedScansNameFileAndByte) {
  fs::create_directory(path("cut"));
  fs::path first;
  for (const auto& entry : fs::recursive_directory_iterator(path("campus")))
    if (entry.path().extension() == ".pcd") first = entry.path();
  ASSERT_FALSE(first.empty());
  const std::string bytes = readFile(first);
  writeFile(path("cut/half.pcd"), bytes.substr(0, bytes.size() / 2));
  expectError(run("info " + path("cut").string()), 4, "half.pcd");
  expectError(run("build " + path("cut").string() + " -o " + fresh()), 4, "half.pcd");
  EXPECT_FALSE(fs::exists(fresh()));
}

}  // namespace
}  // namespace cluxel::app
