// SPDX-License-Identifier: Apache-2.0
// Including, overriding and ordering across rule files.
#include <gmock/gmock.h>

#include "base/file_bytes.hpp"
#include "rules/reasoning_fixture.hpp"
#include "test_paths.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

const std::string kBase = R"(apiVersion: cluxel.rules/v1
prefixes: { clx: "https://w3id.org/cluxel/ontology#" }
constants: { low: 0.5 m }
order: [clx:Ground, clx:SmallObject]
rules:
  - id: ground/main
    class: clx:Ground
    seed: { label: horizontal_plane }
    tree: { accept: { confidence: 0.9 } }
  - id: small/rest
    class: clx:SmallObject
    seed: { label: small_structure }
    tree:
      test: { attribute: height, op: ">=", value: $low }
      yes: { accept: { confidence: 0.6 } }
      no: { reject: too low }
)";

LoadedRules loadOver(const std::string& text) {
  const std::vector<RuleSource> sources{{"mine.yaml", "apiVersion: cluxel.rules/v1\n" + text}, {"base.yaml", kBase}};
  return loadRuleTexts(sources, 1, outdoorCatalogue());
}

double thresholdOf(const LoadedRules& loaded) {
  const Rule* rule = loaded.rules->find("small/rest");
  return std::get<BranchNode>(rule->nodes[0].what).condition.value->value;
}

TEST(RuleIncluding, BringsRulesConstantsAndOrder) {
  const LoadedRules loaded = loadOver("include: [ base.yaml ]\n");
  ASSERT_TRUE(loaded.rules.has_value()) << format(loaded.diagnostics);
  EXPECT_EQ(loaded.rules->rules.size(), 2U);
  EXPECT_DOUBLE_EQ(thresholdOf(loaded), 0.5);
  EXPECT_EQ(loaded.rules->sources.size(), 2U);
}

TEST(RuleIncluding, LetsConstantsAndRulesBeOverridden) {
  const LoadedRules loaded = loadOver(R"(include: [ base.yaml ]
override:
  constants: { low: 0.8 m }
  rules:
    - id: ground/main
      seed: { label_in: [horizontal_plane, scatter] }
)");
  ASSERT_TRUE(loaded.rules.has_value()) << format(loaded.diagnostics);
  EXPECT_DOUBLE_EQ(thresholdOf(loaded), 0.8);
  EXPECT_EQ(loaded.rules->find("ground/main")->seed.labels.size(), 2U);
  EXPECT_EQ(loaded.rules->find("ground/main")->nodes.size(), 1U) << "keys that are not given stay";
}

TEST(RuleIncluding, LetsRulesBeRemoved) {
  const LoadedRules loaded =
      loadOver("include: [ base.yaml ]\norder: [clx:Ground]\noverride: { remove: [ small/rest ] }\n");
  ASSERT_TRUE(loaded.rules.has_value()) << format(loaded.diagnostics);
  EXPECT_EQ(loaded.rules->rules.size(), 1U);
}

TEST(RuleIncluding, InsertsIntoTheOrder) {
  const LoadedRules loaded =
      loadOver("include: [ base.yaml ]\norder: { insert: [clx:Bush], before: clx:SmallObject }\n");
  ASSERT_TRUE(loaded.rules.has_value()) << format(loaded.diagnostics);
  EXPECT_EQ(loaded.rules->order, (std::vector<std::string>{clx("Ground"), clx("Bush"), clx("SmallObject")}));
}

TEST(RuleIncluding, RefusesAnInsertionThatStandsInAList) {
  const LoadedRules loaded =
      loadOver("include: [ base.yaml ]\norder: [ { insert: [clx:Bush], before: clx:SmallObject } ]\n");
  ASSERT_EQ(loaded.diagnostics.size(), 1U) << format(loaded.diagnostics);
  EXPECT_THAT(loaded.diagnostics.front().message, ::testing::HasSubstr("'order' is a list of classes, or one mapping"));
  EXPECT_THAT(loaded.diagnostics.front().hint, ::testing::HasSubstr("order: { insert: "));
}

TEST(RuleIncluding, FindsCycles) {
  const std::vector<RuleSource> sources{{"a.yaml", "apiVersion: cluxel.rules/v1\ninclude: [ b.yaml ]\n"},
                                        {"b.yaml", "apiVersion: cluxel.rules/v1\ninclude: [ a.yaml ]\n"}};
  const LoadedRules loaded = loadRuleTexts(sources, 1, outdoorCatalogue());
  ASSERT_FALSE(loaded.diagnostics.empty());
  EXPECT_EQ(loaded.diagnostics.front().location.file, "b.yaml");
  EXPECT_EQ(loaded.diagnostics.front().location.line, 2U);
  EXPECT_THAT(loaded.diagnostics.front().message, ::testing::HasSubstr("a.yaml -> b.yaml -> a.yaml"));
}

TEST(RuleIncluding, ReadsAFileOnceThoughTwoFilesIncludeIt) {
  const std::vector<RuleSource> sources{{"a.yaml", "apiVersion: cluxel.rules/v1\ninclude: [ b.yaml, base.yaml ]\n"},
                                        {"b.yaml", "apiVersion: cluxel.rules/v1\ninclude: [ base.yaml ]\n"},
                                        {"base.yaml", kBase}};
  const LoadedRules loaded = loadRuleTexts(sources, 1, outdoorCatalogue());
  EXPECT_TRUE(loaded.rules.has_value()) << format(loaded.diagnostics);
}

TEST(RuleIncluding, ReportsAMissingFileWhereItIsNamed) {
  const LoadedRules loaded = loadOver("include: [ base.yaml, gone.yaml ]\n");
  ASSERT_EQ(loaded.diagnostics.size(), 1U);
  EXPECT_EQ(loaded.diagnostics[0].location.line, 2U);
  EXPECT_THAT(loaded.diagnostics[0].message, ::testing::HasSubstr("gone.yaml"));
}

TEST(RuleIncluding, TellsOfUnreadableFilesWithTheWordErrorOnce) {
  const auto folder = test::buildFolder() / "rule_include_faults";
  std::filesystem::create_directories(folder);
  writeFile(folder / "mine.yaml", "apiVersion: cluxel.rules/v1\ninclude: [ gone.yaml ]\n");
  const auto textOf = [](const std::filesystem::path& root) {
    const std::vector<std::filesystem::path> paths{root};
    return format(checkRules(paths, outdoorCatalogue()).front());
  };
  EXPECT_EQ(textOf(folder), folder.string() + ": error: is a folder, a file was expected");
  EXPECT_THAT(textOf(folder / "mine.yaml"), ::testing::StartsWith((folder / "mine.yaml").string() +
                                                                  ":2:12: error: " + (folder / "gone.yaml").string() +
                                                                  ": cannot be opened: No such file"));
  std::filesystem::remove_all(folder);
}

TEST(RuleIncluding, RefusesToChangeWhatIsNotThere) {
  const LoadedRules loaded =
      loadOver("include: [ base.yaml ]\noverride: { rules: [ { id: ground/mian } ], constants: { lo: 1 m } }\n");
  ASSERT_EQ(loaded.diagnostics.size(), 2U) << format(loaded.diagnostics);
  EXPECT_THAT(loaded.diagnostics[0].hint, ::testing::HasSubstr("ground/main"));
  EXPECT_THAT(loaded.diagnostics[1].hint, ::testing::HasSubstr("low"));
}

TEST(RuleIncluding, RefusesOverridesThatWouldDoNothing) {
  for (const char* overrides : {"{ remove: small/rest }", "{ remove: { small/rest: true } }", "{ rules: small/rest }",
                                "{ rules: { id: small/rest, class: clx:SmallObject } }", "{ constants: 5 }"}) {
    const LoadedRules loaded = loadOver("include: [ base.yaml ]\noverride: " + std::string(overrides) + "\n");
    ASSERT_FALSE(loaded.diagnostics.empty()) << overrides;
    EXPECT_EQ(loaded.diagnostics[0].severity, Severity::Error) << overrides;
    EXPECT_EQ(loaded.diagnostics[0].location.line, 3U) << overrides;
  }
}

TEST(RuleIncluding, FindsFilesBesideTheIncludingOne) {
  const auto folder = test::buildFolder() / "rule_include_folder";
  std::filesystem::create_directories(folder / "deep");
  writeFile(folder / "base.yaml", kBase);
  writeFile(folder / "deep/mine.yaml", "apiVersion: cluxel.rules/v1\ninclude: [ ../base.yaml ]\n");
  const std::vector<std::filesystem::path> paths{folder / "deep/mine.yaml"};
  EXPECT_TRUE(checkRules(paths, outdoorCatalogue()).empty());
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace cluxel::testing
