// SPDX-License-Identifier: Apache-2.0
// The rule test engine: the shipped tests pass, and wrong expectations fail.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rules/reasoning_fixture.hpp"
#include "rules/testing/rule_mutation.hpp"
#include "rules/testing/rule_test.hpp"
#include "test_paths.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

TEST(ShippedRuleTests, PassAndReachMostLeaves) {
  const RuleTestReport report =
      runRuleTests(test::sourceFolder() / "rules/outdoor.rules-test.yaml", outdoorCatalogue());
  EXPECT_TRUE(report.passed()) << textOf(report);
  const auto reached =
      std::count_if(report.leaves.begin(), report.leaves.end(), [](const LeafCoverage& leaf) { return leaf.hits > 0; });
  EXPECT_GE(static_cast<double>(reached), 0.9 * static_cast<double>(report.leaves.size())) << textOf(report);
}

/// A test file in its own folder, beside one rule file.
class RuleTestFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = test::buildFolder() / "rule_test_folder" / info->name();
    std::filesystem::create_directories(folder_);
    writeFile(folder_ / "bin.rules.yaml", R"(apiVersion: cluxel.rules/v1
prefixes: { clx: "https://w3id.org/cluxel/ontology#" }
order: [clx:SmallObject]
rules:
  - id: bin/one
    class: clx:SmallObject
    seed: { label: small_structure }
    tree:
      test: { attribute: height, op: "<=", value: 1 m }
      yes: { accept: { confidence: 0.7 } }
      no: { reject: too high }
)");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  RuleTestReport run(const std::string& tests, const RuleTestOptions& options = {}) {
    writeFile(folder_ / "bin.rules-test.yaml",
              "apiVersion: cluxel.rules.test/v1\nrules: [ bin.rules.yaml ]\ntests:\n" + tests);
    return runRuleTests(folder_ / "bin.rules-test.yaml", outdoorCatalogue(), options);
  }
  static std::string binTest(const std::string& expect, const std::string& more = "") {
    return "  - name: a bin\n" + more +
           "    primitives: { b: { label: small_structure, box: { center: [0, 0, 0.5], size: [1, 1, 0.9] } } }\n"
           "    expect: " +
           expect + "\n";
  }

  std::filesystem::path folder_;
};

TEST_F(RuleTestFolder, WantsAnObjectOfItsOwnForEveryExpectation) {
  const std::string two = "{ objects: [ { class: clx:SmallObject }, { class: clx:SmallObject } ] }";
  EXPECT_FALSE(run(binTest(two)).passed()) << "one bin is not two";
  const std::string mixed =
      "{ objects: [ { class: clx:SmallObject }, { class: clx:SmallObject, primitives: { clx:SmallObject: [b] } } ] }";
  const std::string both =
      "  - name: two bins\n    primitives:\n"
      "      b: { label: small_structure, box: { center: [0, 0, 0.5], size: [1, 1, 0.9] } }\n"
      "      c: { label: small_structure, box: { center: [9, 0, 0.5], size: [1, 1, 0.9] } }\n    expect: ";
  EXPECT_TRUE(run(both + two + "\n").passed());
  const RuleTestReport report = run(both + mixed + "\n");
  EXPECT_TRUE(report.passed()) << textOf(report);
}

TEST_F(RuleTestFolder, PassesWhenAllExpectationsComeTrue) {
  const RuleTestReport report =
      run(binTest("{ objects: [ { class: clx:SmallObject, primitives: [b], confidence: \">= 0.7\", rule: bin/one } ], "
                  "exactly: true }"));
  EXPECT_TRUE(report.passed()) << textOf(report);
  EXPECT_EQ(report.leaves.size(), 2U);
  EXPECT_EQ(report.leaves[0].hits, 1U);
  EXPECT_EQ(report.leaves[1].hits, 0U);
  EXPECT_THAT(textOf(report), ::testing::HasSubstr("no test reaches"));
}

TEST_F(RuleTestFolder, FailsForEachWrongExpectation) {
  for (const std::string expect :
       {"{ objects: [ { class: clx:Bush, primitives: [b] } ] }",
        "{ objects: [ { class: clx:SmallObject, confidence: \"> 0.7\" } ] }", "{ not: [ clx:SmallObject ] }",
        "{ not: [ clx:Object ] }", "{ count: { clx:SmallObject: 2 } }", "{ exactly: true }",
        "{ reasons: [ { primitive: b, rule: bin/one, reason: too high } ] }"}) {
    const RuleTestReport report = run(binTest(expect));
    EXPECT_FALSE(report.passed()) << expect;
    EXPECT_EQ(report.count(RuleTestOutcome::Failed), 1U) << expect;
  }
}

TEST_F(RuleTestFolder, CountsKnownFailuresButNotAsFailures) {
  const RuleTestReport failing = run(binTest("{ count: { clx:SmallObject: 2 } }", "    todo: true\n"));
  EXPECT_TRUE(failing.passed());
  EXPECT_EQ(failing.count(RuleTestOutcome::KnownFailure), 1U);
  const RuleTestReport passing = run(binTest("{ count: { clx:SmallObject: 1 } }", "    todo: true\n"));
  EXPECT_FALSE(passing.passed()) << "a todo that passes must be noticed";
}

TEST_F(RuleTestFolder, ReportsFaultsOfTheTestFileAllAtOnce) {
  try {
    run(binTest("{ objects: [ { class: clx:Bsh, primitives: [c] } ], exactli: true }"));
    FAIL() << "a faulty file was run";
  } catch (const InputError& fault) {
    EXPECT_EQ(fault.diagnostics().size(), 3U) << fault.what();
  }
}

TEST_F(RuleTestFolder, TakesTheBoxesOfAnEarlierTestAndChangesThem) {
  const std::string one = binTest("{ count: { clx:SmallObject: 1 } }");
  const auto like = [&](const std::string& primitives, const std::string& expect) {
    return run(one + "  - name: another\n    like: a bin\n    primitives: " + primitives + "\n    expect: " + expect +
               "\n");
  };
  EXPECT_TRUE(like("{ b: { attributes: { height: 2 m } } }", "{ count: { clx:SmallObject: 0 } }").passed());
  EXPECT_TRUE(
      like("{ b: { box: { center: [0, 0, 2], size: [1, 1, 3] } } }", "{ count: { clx:SmallObject: 0 } }").passed());
  EXPECT_TRUE(like("{ c: { label: small_structure, box: { center: [5, 0, 0.5], size: [1, 1, 0.9] } } }",
                   "{ count: { clx:SmallObject: 2 } }")
                  .passed());
  EXPECT_THROW(like("{ c: { attributes: { height: 2 m } } }", "{ exactly: true }"), InputError) << "c has no box";
  EXPECT_THROW(run("  - name: first\n    like: a bin\n    expect: { exactly: true }\n" + one), InputError)
      << "only earlier tests can be taken";
}

TEST_F(RuleTestFolder, RefusesExpectationsThatWouldDoNothing) {
  for (const char* expect :
       {"{ not: clx:SmallObject }", "{ exactly: true, not: clx:SmallObject }", "{ count: 3 }", "{ reasons: b }",
        "{ objects: { class: clx:Tree } }", "{}", "{ objects: [] }", "{ exactly: false }", "{ not: }"})
    EXPECT_THROW(run(binTest(expect)), InputError) << expect;
}

TEST_F(RuleTestFolder, TakesScenesFromTheProviderAndSkipsWithoutOne) {
  const std::string test = "  - name: a map\n    map: some.clx\n    expect: { count: { clx:SmallObject: 0 } }\n";
  EXPECT_EQ(run(test).count(RuleTestOutcome::Skipped), 1U);
  std::filesystem::path asked;
  RuleTestOptions options;
  options.scenes = [&](const SceneRequest& request) {
    asked = request.path;
    Scene scene;
    scene.relation_offset = {0};
    scene.cluxels.edge_offset = {0};
    return scene;
  };
  EXPECT_TRUE(run(test, options).passed());
  EXPECT_EQ(asked, folder_ / "some.clx");
}

TEST_F(RuleTestFolder, ComparesWithGoldenObjects) {
  writeFile(folder_ / "golden.json",
            R"({"objects": [{"class": "clx:SmallObject", "min": [-0.5, -0.5, 0.05], "max": [0.5, 0.5, 0.95]}]})");
  EXPECT_TRUE(run(binTest("{ golden: golden.json, min_precision: 1, min_recall: 1 }")).passed());
  writeFile(folder_ / "golden.json",
            R"({"objects": [{"class": "clx:SmallObject", "min": [3, 3, 0], "max": [4, 4, 1]}]})");
  EXPECT_FALSE(run(binTest("{ golden: golden.json, min_precision: 0.5 }")).passed());
}

TEST_F(RuleTestFolder, CountsObjectsOfClassesThatTheGoldenFileLacks) {
  const std::string test = binTest("{ golden: golden.json, min_precision: 0.9, min_recall: 0 }");
  writeFile(folder_ / "golden.json", R"({"objects": [{"class": "clx:Tree", "min": [3, 3, 0], "max": [4, 4, 1]}]})");
  const RuleTestReport report = run(test);
  EXPECT_FALSE(report.passed());
  EXPECT_NE(textOf(report).find("these are no golden objects: 1 clx:SmallObject"), std::string::npos) << textOf(report);
  writeFile(folder_ / "golden.json", R"({"objects": []})");
  EXPECT_FALSE(run(test).passed()) << "a file that was cut short";
}

TEST_F(RuleTestFolder, TellsWhatIsWrongWithAGoldenFile) {
  const std::string test = binTest("{ golden: golden.json, min_recall: 1 }");
  for (const auto& [text, fault] : std::initializer_list<std::pair<const char*, const char*>>{
           {"{\"objects\": [\n", "golden.json:2:"},
           {"null", "there is null where an object {…} or a list […] is wanted"},
           {"{}", "it has no 'objects'"},
           {R"({"objects": 3})", "'objects' is not a list"},
           {R"({"objects": [{"class": "clx:Tree", "min": [0, 0, 0]}]})", "object 1: it has no 'max'"},
           {R"({"objects": [{"class": "clx:Tree", "min": [0, 0], "max": [1, 1, 1]}]})", "a list is too short"},
           {R"({"objects": [{"class": 5, "min": [0, 0, 0], "max": [1, 1, 1]}]})",
            "there is a number where a text is wanted"}}) {
    writeFile(folder_ / "golden.json", text);
    const std::string report = textOf(run(test));
    EXPECT_NE(report.find(fault), std::string::npos) << report;
    EXPECT_EQ(report.find("json.exception"), std::string::npos) << report;
  }
}

TEST_F(RuleTestFolder, AFileThatCannotBeReadIsNoKnownFailure) {
  EXPECT_FALSE(run(binTest("{ golden: absent.json, min_recall: 1 }", "    todo: true\n")).passed());
}

TEST_F(RuleTestFolder, WritesJsonAndJunit) {
  const RuleTestReport report = run(binTest("{ not: [ clx:SmallObject ] }"));
  const auto json = nlohmann::json::parse(jsonOf(report));
  EXPECT_FALSE(json.at("passed").get<bool>());
  EXPECT_EQ(json.at("tests").at(0).at("outcome"), "failed");
  EXPECT_EQ(json.at("leaves").size(), 2U);
  const std::string xml = junitOf(report, "rules <1>");
  EXPECT_THAT(xml, ::testing::HasSubstr("<testsuite name=\"rules &lt;1&gt;\" tests=\"1\" failures=\"1\""));
}

TEST_F(RuleTestFolder, CountsBothWaysOutOfEachBranch) {
  const RuleTestReport report = run(binTest("{ count: { clx:SmallObject: 1 } }"));
  ASSERT_EQ(report.branches.size(), 2U);
  EXPECT_EQ(report.branches[0].way, "yes");
  EXPECT_EQ(report.branches[0].hits, 1U);
  EXPECT_EQ(report.branches[1].hits, 0U);
}

TEST_F(RuleTestFolder, CountsTheWayOfEndsThatNoScanShows) {
  writeFile(folder_ / "bin.rules.yaml", R"(apiVersion: cluxel.rules/v1
prefixes: { clx: "https://w3id.org/cluxel/ontology#" }
order: [clx:SmallObject]
rules:
  - id: bin/one
    class: clx:SmallObject
    seed: { label: small_structure }
    tree:
      test: height <= 1 m
      yes: { accept: { confidence: 0.7 } }
      unseen:
        test: width <= 1 m
        yes: { accept: { confidence: 0.5 } }
        no: { reject: too wide }
      no: { reject: too high }
)");
  const auto hitsOfUnseen = [&](const std::string& view) {
    for (const BranchCoverage& branch : run(binTest("{ count: { clx:SmallObject: 1 } }", view)).branches)
      if (branch.way == "unseen") return static_cast<int>(branch.hits);
    return -1;
  };
  EXPECT_EQ(hitsOfUnseen("    views: [ { from: [-10, 0, 2], up_to: -5.8 deg } ]\n"), 1);
  EXPECT_EQ(hitsOfUnseen("    views: [ { from: [-10, 0, 2], up_to: 8 deg } ]\n"), 0);
}

TEST_F(RuleTestFolder, CoversTheRulesOfItsFilesAndNotOfThoseTheyInclude) {
  writeFile(folder_ / "mine.rules.yaml", R"(apiVersion: cluxel.rules/v1
include: [ bin.rules.yaml ]
rules:
  - id: bin/two
    class: clx:SmallObject
    seed: { label: column }
    tree: { accept: { confidence: 0.7 } }
)");
  writeFile(folder_ / "mine.rules-test.yaml", "apiVersion: cluxel.rules.test/v1\nrules: [ mine.rules.yaml ]\ntests:\n" +
                                                  binTest("{ count: { clx:SmallObject: 1 } }"));
  const RuleTestReport report = runRuleTests(folder_ / "mine.rules-test.yaml", outdoorCatalogue());
  ASSERT_EQ(report.leaves.size(), 1U);
  EXPECT_EQ(report.leaves[0].rule_id, "bin/two");
}

TEST_F(RuleTestFolder, NoticesTheMutantsThatItsTestsTellApart) {
  const std::string low = binTest("{ count: { clx:SmallObject: 1 } }");
  run(low);
  const auto file = folder_ / "bin.rules-test.yaml";
  const RuleMutationReport one = mutateRules(file, outdoorCatalogue(), {}, 1);
  // A bin of 0.9 m: halving 1 m, turning the comparison and exchanging the leaves is noticed, doubling is not.
  ASSERT_EQ(one.mutants.size(), 4U);
  EXPECT_EQ(one.killed(), 3U) << textOf(one);
  EXPECT_THAT(textOf(one), ::testing::HasSubstr("threshold doubled"));
  std::string high = binTest("{ count: { clx:SmallObject: 0 } }");
  high.replace(high.find("0.5], size: [1, 1, 0.9]"), 23, "0.75], size: [1, 1, 1.5]");
  high.replace(high.find("a bin"), 5, "a box");
  run(low + high);
  const RuleMutationReport both = mutateRules(file, outdoorCatalogue(), {}, 2);
  EXPECT_EQ(both.score(), 1) << textOf(both);
  EXPECT_TRUE(both.untouchedRules().empty());
  EXPECT_EQ(nlohmann::json::parse(jsonOf(both)).at("killed"), 4);
}

TEST_F(RuleTestFolder, ListsRulesThatNoMutantTouches) {
  run("  - name: nothing\n    primitives: { b: { label: scatter, box: { center: [0, 0, 0.5], size: [1, 1, 0.9] } } }\n"
      "    expect: { count: { clx:SmallObject: 0 } }\n");
  const RuleMutationReport report = mutateRules(folder_ / "bin.rules-test.yaml", outdoorCatalogue(), {}, 1);
  EXPECT_EQ(report.untouchedRules(), std::vector<std::string>{"bin/one"});
  EXPECT_EQ(report.score(), 0);
}

TEST_F(RuleTestFolder, WritesGoldenFilesThatThenPass) {
  const std::string golden = binTest("{ golden: objects.json, min_precision: 1, min_recall: 1 }");
  EXPECT_FALSE(run(golden).passed());
  const auto written = updateGolden(folder_ / "bin.rules-test.yaml", outdoorCatalogue());
  ASSERT_EQ(written.size(), 1U);
  EXPECT_TRUE(run(golden).passed());
  writeFile(folder_ / "objects.json", "rules: []\n");
  EXPECT_THROW(updateGolden(folder_ / "bin.rules-test.yaml", outdoorCatalogue()), Error);
  EXPECT_EQ(readFile(folder_ / "objects.json"), "rules: []\n") << "a file of another purpose";
  EXPECT_EQ(filesOfRuleTests(folder_ / "bin.rules-test.yaml", outdoorCatalogue()).size(), 2U);
}

}  // namespace
}  // namespace cluxel::testing
