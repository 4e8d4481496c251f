// SPDX-License-Identifier: Apache-2.0
// The program as its users meet it: exit codes, what goes to stdout, and what errors say.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "cluxel/base/file_bytes.hpp"
#include "knowledge/scratch_folder.hpp"

namespace cluxel {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct Outcome {
  int code = -1;
  std::string out, err;
};

class Program : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new ScratchFolder;
    writeFile(path("three.ttl"), "@prefix e: <https://e.org/> .\ne:a e:p 1 . e:b e:p 2 . e:c e:p 3 .\n");
    const Outcome campus = run("simulate " + path("campus").string() + " --stops 2 --size 50 --points-per-stop 3000 --json");
    simulated = campus.out;
    built = run("build " + path("campus").string() + " -o " + path("map.clx").string() + " --json");
  }
  static void TearDownTestSuite() { delete folder; }
  static fs::path path(const std::string& name) { return folder->path() / name; }

  static Outcome run(const std::string& arguments) {
    const std::string err = (folder->path() / "stderr").string(), out = (folder->path() / "stdout").string();
    const std::string command = std::string(CLUXEL_BINARY_DIR) + "/cluxel --home " + CLUXEL_SOURCE_DIR + " --threads 1 " +
                                arguments + " > " + out + " 2> " + err;
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readFile(out), readFile(err)};
  }
  static Outcome query(const std::string& source, const std::string& text, const std::string& more = "") {
    return run("query " + path(source).string() + " -e '" + text + "' " + more);
  }
  static inline ScratchFolder* folder = nullptr;
  static inline std::string simulated;
  static inline Outcome built;
};

void expectError(const Outcome& outcome, int code, const std::string& words) {
  EXPECT_EQ(outcome.code, code) << outcome.err;
  EXPECT_EQ(outcome.out, "") << "errors go to stderr";
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
}

TEST_F(Program, BuildsAMapAndTellsSoInJson) {
  ASSERT_EQ(built.code, 0) << built.err;
  const Json report = Json::parse(built.out);
  EXPECT_EQ(report.at("scans"), 2);
  EXPECT_GT(report.at("objects"), 0);
  EXPECT_EQ(Json::parse(simulated).at("scans"), 2);
  const Json info = Json::parse(run("info " + path("map.clx").string() + " --json").out);
  EXPECT_EQ(info.at("clouds"), 2);
  EXPECT_EQ(info.at("finished"), true);
  EXPECT_EQ(info.at("objects"), report.at("objects"));
  EXPECT_EQ(Json::parse(run("info " + path("campus").string() + " --json").out).at("scans").size(), 2U);
}

TEST_F(Program, AnswersWithExitCodeZeroAndData) {
  const Outcome rows = query("three.ttl", "SELECT ?o WHERE { ?s ?p ?o } ORDER BY ?o", "--format csv");
  EXPECT_EQ(rows.code, 0);
  EXPECT_EQ(rows.out, "o\r\n1\r\n2\r\n3\r\n");
  const Json json = Json::parse(query("three.ttl", "SELECT ?o WHERE { ?s ?p ?o }", "--json").out);
  EXPECT_EQ(json.at("results").at("bindings").size(), 3U);
}

TEST_F(Program, AnAskThatIsFalseIsExitCodeOneAndATrueOneZero) {
  EXPECT_EQ(query("three.ttl", "ASK { ?s ?p 4 }").code, 1);
  EXPECT_EQ(query("three.ttl", "ASK { ?s ?p 3 }").code, 0);
}

TEST_F(Program, AWrongCommandLineIsExitCodeTwo) {
  expectError(run("query --no-such-option"), 2, "");
  expectError(run(""), 2, "");
  expectError(run("no-such-command"), 2, "");
  expectError(run("query " + path("three.ttl").string()), 2, "-e TEXT");
  expectError(query("three.ttl", "ASK { }", "--param a=1"), 2, "a=1");
  expectError(query("three.ttl", "ASK { }", "--format docx"), 2, "docx");
  expectError(run("build " + path("campus").string() + " -o " + path("map.clx").string()), 2, "--force");
}

TEST_F(Program, NoRowsAreExitCodeThree) { EXPECT_EQ(query("three.ttl", "SELECT * WHERE { ?s ?p 4 }").code, 3); }

TEST_F(Program, FaultyInputIsExitCodeFourAndNamesFileAndLine) {
  writeFile(path("broken.rq"), "SELECT *\nWHERE { ?s ?p }\n");
  expectError(run("query " + path("three.ttl").string() + " " + path("broken.rq").string()), 4, "broken.rq:2:");
  writeFile(path("broken.ttl"), "@prefix e: <https://e.org/> .\ne:a e:p ;\n");
  expectError(query("broken.ttl", "ASK { }"), 4, "broken.ttl:");
  writeFile(path("broken.pcd"), "VERSION .7\nFIELDS x y\nSIZE 4 four\n");
  expectError(run("info " + path("broken.pcd").string()), 4, "broken.pcd:");
  expectError(run("info " + path("absent.pcd").string()), 4, "absent.pcd");
  expectError(run("build " + path("absent.pcd").string() + " -o " + path("never.clx").string()), 4, "absent.pcd");
  EXPECT_FALSE(fs::exists(path("never.clx")));
  expectError(run("query " + path("three.ttl").string() + " no-such-question"), 4, "no-such-question");
}

TEST_F(Program, FaultyRulesAreExitCodeFourWithLineAndCaret) {
  writeFile(path("faulty.rules.yaml"), "apiVersion: cluxel.rules/v1\nordr: [clx:Tree]\n");
  const Outcome text = run("rules check " + path("faulty.rules.yaml").string());
  EXPECT_EQ(text.code, 4);
  EXPECT_NE((text.out + text.err).find("faulty.rules.yaml:2:"), std::string::npos) << text.out << text.err;
  const Outcome json = run("rules check --json " + path("faulty.rules.yaml").string());
  EXPECT_EQ(json.code, 4);
  EXPECT_GE(Json::parse(json.out).size(), 1U);
  EXPECT_EQ(Json::parse(json.out)[0].at("line"), 2);
}

TEST_F(Program, TheShippedRulesHaveNoFaults) {
  const Outcome check = run("rules check --json");
  EXPECT_EQ(check.code, 0);
  for (const Json& fault : Json::parse(check.out)) EXPECT_NE(fault.at("severity"), "error") << fault;
}

TEST_F(Program, WhatIsNoMapIsExitCodeFive) {
  writeFile(path("no-map.clx"), std::string(20'000, 'x'));
  expectError(query("no-map.clx", "ASK { }"), 5, "no-map.clx");
  expectError(run("export " + path("no-map.clx").string() + " --canonical"), 5, "no-map.clx");
}

TEST_F(Program, ASpentBudgetIsExitCodeSixWithoutHalfAnAnswer) {
  expectError(query("three.ttl", "SELECT * WHERE { ?s ?p ?o }", "--max-rows 2"), 6, "");
  expectError(query("map.clx", "SELECT (COUNT(*) AS ?n) WHERE { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }", "--deadline 0.05"), 6, "");
}

TEST_F(Program, ListsItsQuestions) {
  const Json tasks = Json::parse(run("tasks --json").out);
  ASSERT_GE(tasks.size(), 5U);
  for (const Json& task : tasks) EXPECT_NE(task.at("title"), "");
}

TEST_F(Program, HelpsWithEverySubcommand) {
  for (const char* name : {"", "info", "simulate", "build", "query", "update", "tasks", "explain", "rules", "rules check",
                           "rules test", "train", "evaluate", "export", "compact", "doctor"}) {
    const Outcome help = run(std::string(name) + " --help");
    EXPECT_EQ(help.code, 0) << name;
    EXPECT_NE(help.out.find("--help"), std::string::npos) << name;
  }
  EXPECT_EQ(run("--version").out.substr(0, 7), "cluxel ");
}

TEST_F(Program, DoctorAndExportAgreeThatTheMapIsWhole) {
  EXPECT_EQ(Json::parse(run("doctor --json " + path("map.clx").string()).out).at("faults").size(), 0U);
  const Outcome once = run("export --canonical " + path("map.clx").string());
  ASSERT_EQ(once.code, 0) << once.err;
  EXPECT_GT(once.out.size(), 1000U);
  ASSERT_EQ(run("compact " + path("map.clx").string() + " -o " + path("small.clx").string()).code, 0);
  EXPECT_EQ(run("export --canonical " + path("small.clx").string()).out, once.out);
}

}  // namespace
}  // namespace cluxel
