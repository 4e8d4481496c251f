// SPDX-License-Identifier: Apache-2.0
// Named fragments: a rule that uses definitions decides as if everything were written out, and faults name their place.
#include <gmock/gmock.h>

#include "base/file_bytes.hpp"
#include "rules/reasoning_fixture.hpp"
#include "test_paths.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
using ::testing::HasSubstr;
namespace {

const std::string kHead = R"(apiVersion: cluxel.rules/v1
prefixes: { clx: "https://w3id.org/cluxel/ontology#" }
order: [clx:Tree]
)";

LoadedRules loadDefined(const std::string& define, const std::string& rules) {
  const std::string text = kHead + "define:\n" + define + "rules:\n" + rules;
  return loadRuleTexts(std::vector{RuleSource{"d.yaml", text}}, 1, outdoorCatalogue());
}

const std::string kUser = R"(  - id: tree/a
    class: clx:Tree
    seed: { label: column, as: trunk }
    tree: { all: { use: tall }, yes: { accept: { confidence: 0.9 } }, no: { reject: low } }
)";

std::string faultOf(const LoadedRules& loaded) {
  return loaded.diagnostics.empty() ? "none" : format(loaded.diagnostics);
}

/// The tests of the first node, in words.
std::string testsOf(const LoadedRules& loaded) {
  return describe(std::get<BranchNode>(loaded.rules->rules[0].nodes[0].what).condition);
}

TEST(RuleDefinition, StandsForWhatItSays) {
  const auto loaded = loadDefined("  tall: [ height >= 2 m, width <= 1 m ]\n", kUser);
  ASSERT_TRUE(loaded.rules.has_value()) << faultOf(loaded);
  EXPECT_EQ(testsOf(loaded), "(height of trunk >= 2 m and width of trunk <= 1 m)");
}

TEST(RuleDefinition, OfAListIsSplicedIntoAListAndMayUseOthers) {
  const auto loaded =
      loadDefined("  thin: [ width <= 1 m ]\n  tall: [ height >= 2 m, { use: thin }, top <= 9 m ]\n", kUser);
  ASSERT_TRUE(loaded.rules.has_value()) << faultOf(loaded);
  EXPECT_EQ(testsOf(loaded), "(height of trunk >= 2 m and width of trunk <= 1 m and top of trunk <= 9 m)");
}

TEST(RuleDefinition, OfAMappingIsExtendedByTheKeysBesideUse) {
  const auto loaded = loadDefined("  leaf: { confidence: 0.4, part: clx:TreeTrunk }\n", R"(  - id: tree/a
    class: clx:Tree
    seed: { label: column }
    tree: { accept: { use: leaf, confidence: 0.9 } }
)");
  ASSERT_TRUE(loaded.rules.has_value()) << faultOf(loaded);
  const auto& accept = std::get<AcceptLeaf>(loaded.rules->rules[0].nodes[0].what);
  EXPECT_EQ(accept.confidence.high, 0.9);
  EXPECT_THAT(accept.parts.front().second, HasSubstr("TreeTrunk"));
}

TEST(RuleDefinition, ThatIsUnknownIsAFaultWithASuggestion) {
  const auto loaded = loadDefined("  tell: [ height >= 2 m ]\n", kUser);
  EXPECT_THAT(faultOf(loaded), HasSubstr("nothing is defined as 'tall'"));
  EXPECT_THAT(faultOf(loaded), HasSubstr("did you mean 'tell'?"));
  EXPECT_EQ(loaded.diagnostics.front().location.line, 10U);
}

TEST(RuleDefinition, ThatUsesItselfIsAFaultThatNamesTheWay) {
  const auto loaded = loadDefined("  tall: [ { use: thin } ]\n  thin: [ { use: tall } ]\n", kUser);
  EXPECT_THAT(faultOf(loaded), HasSubstr("the definitions use each other: tall -> thin -> tall"));
}

TEST(RuleDefinition, ThatNobodyUsesIsAWarning) {
  const auto loaded = loadDefined("  tall: [ height >= 2 m ]\n  other: [ width <= 1 m ]\n", kUser);
  ASSERT_TRUE(loaded.rules.has_value()) << faultOf(loaded);
  ASSERT_EQ(loaded.diagnostics.size(), 1U);
  EXPECT_EQ(loaded.diagnostics[0].message, "the definition 'other' is not used");
  EXPECT_EQ(loaded.diagnostics[0].location.line, 6U);
}

TEST(RuleDefinition, ThatNobodyUsesIsLookedInto) {
  const std::string tall = "  tall: [ height >= 2 m ]\n";
  EXPECT_THAT(faultOf(loadDefined(tall + "  x1: { use: x2 }\n  x2: { use: x1 }\n", kUser)),
              HasSubstr("the definitions use each other: x1 -> x2 -> x1"));
  EXPECT_THAT(faultOf(loadDefined(tall + "  zz: [ { use: tal } ]\n", kUser)),
              ::testing::AllOf(HasSubstr("d.yaml:6:"), HasSubstr("nothing is defined as 'tal'")));
  const auto loaded = loadDefined(tall + "  yy: [ { use: zz } ]\n  zz: [ width <= 1 m ]\n", kUser);
  ASSERT_TRUE(loaded.rules.has_value()) << faultOf(loaded);
  EXPECT_EQ(loaded.diagnostics.size(), 2U) << "neither is used by a rule";
}

TEST(RuleDefinition, ThatMultipliesWithoutEndIsAFault) {
  std::string define = "  d0: [ height >= 2 m ]\n";
  for (int i = 1; i < 40; ++i) {
    const std::string use = "{ use: d" + std::to_string(i - 1) + " }";
    define += "  d" + std::to_string(i) + ": [ " + use + ", " + use + " ]\n";
  }
  const auto loaded = loadDefined(define + "  tall: { use: d39 }\n", kUser);
  EXPECT_THAT(faultOf(loaded), HasSubstr("the definitions make the rules longer"));
}

TEST(RuleDefinition, MayBeOverriddenByTheFileThatIncludesIt) {
  const std::vector<RuleSource> sources{
      {"mine.yaml",
       "apiVersion: cluxel.rules/v1\ninclude: [ base.yaml ]\noverride:\n  define: { tall: [ height >= 5 m ] }\n"},
      {"base.yaml", kHead + "define: { tall: [ height >= 2 m ] }\nrules:\n" + kUser}};
  const auto loaded = loadRuleTexts(sources, 1, outdoorCatalogue());
  ASSERT_TRUE(loaded.rules.has_value()) << faultOf(loaded);
  EXPECT_EQ(testsOf(loaded), "height of trunk >= 5 m");
}

Condition readOne(const std::string& condition) {
  const auto loaded = loadDefined("  tall: [ " + condition + " ]\n", R"(  - id: tree/a
    class: clx:Tree
    seed: { label_in: [column, scatter, small_structure], as: trunk }
    tree:
      find: { as: crown, label_in: [scatter, vertical_plane], where: [ gap to trunk <= 1 m ] }
      found: { all: { use: tall }, yes: { accept: { confidence: 0.9 } }, no: { reject: low } }
      missing: { reject: none }
)");
  EXPECT_TRUE(loaded.rules.has_value()) << faultOf(loaded);
  if (!loaded.rules) return {};
  return std::get<BranchNode>(loaded.rules->rules[0].nodes[1].what).condition.operands.at(0);
}

TEST(ConditionText, IsReadAsTheMappingThatItIsShortFor) {
  const std::vector<std::pair<std::string, std::string>> pairs{
      {"height of crown >= 2.5 m", "{ of: crown, attribute: height, op: \">=\", value: 2.5 m }"},
      {"width outside 10 cm and 2 m", "{ attribute: width, op: outside, min: 10 cm, max: 2 m }"},
      {"height >= 1.3 x width of crown",
       "{ attribute: height, op: \">=\", ratio: 1.3, to: { of: crown, attribute: width } }"},
      {"length >= height", "{ attribute: length, op: \">=\", to: { attribute: height } }"},
      {"length of crown from 0.2 m to 1 m >= 2 x length from 1 m to 2 m",
       "{ of: crown, slice: { from: 0.2 m, to: 1 m }, attribute: length, op: \">=\", ratio: 2, to: { slice: { from: 1 "
       "m, "
       "to: 2 m }, attribute: length } }"},
      {"gap to crown <= 0.5 m", "{ gap_to: crown, op: \"<=\", value: 0.5 m }"},
      {"adjacent_fraction of crown to scatter >= 0.5",
       "{ of: crown, adjacent_fraction_to: { label: scatter }, op: \">=\", value: 0.5 }"},
      {"gap to clx:Tree < 1 m", "{ gap_to: { object: clx:Tree }, op: \"<\", value: 1 m }"},
      {"touches clx:Tree", "{ relation: touches, with: { object: clx:Tree } }"},
      {"crown above trunk within 1 m", "{ of: crown, relation: above, with: trunk, within: 1 m }"},
      {"touches_ground within 0.2 m", "{ relation: touches_ground, within: 0.2 m }"},
      {"is column or scatter", "{ label_in: [column, scatter] }"},
      {"crown is scatter", "{ of: crown, label: scatter }"},
      {"vertical_plane or column share of crown <= 0.6",
       "{ of: crown, label_in: [vertical_plane, column], op: \"<=\", value: 0.6 }"},
      {"column share > 50 %", "{ label: column, op: \">\", value: 50 % }"},
      {"not height > 1 m", "{ not: { attribute: height, op: \">\", value: 1 m } }"},
      {"normal_tilt <= 30 deg", "{ attribute: normal_tilt, op: \"<=\", value: 30 deg }"}};
  for (const auto& [text, mapping] : pairs) EXPECT_EQ(describe(readOne(text)), describe(readOne(mapping))) << text;
}

TEST(ConditionText, PointsAtTheWordThatIsWrong) {
  const std::vector<std::pair<std::string, std::string>> faults{
      {"hieght >= 2 m", "did you mean 'height'?"},
      {"height => 2 m", "unknown operator '=>'"},
      {"height >= 2", "a bare number where a length is expected"},
      {"height of stem >= 2 m", "nothing is bound to 'stem'"},
      {"height between 1 m", "'and' is missing"},
      {"gap clx:Tree <= 1 m", "'to' is missing"},
      {"is", "a label is missing"},
      {"height >= 1 m and", "the condition must end here"},
      {"touches clx:Twig", "the ontology knows no class 'clx:Twig'"}};
  for (const auto& [text, message] : faults) {
    const auto loaded = loadDefined("  tall: [ " + text + " ]\n", kUser);
    EXPECT_THAT(faultOf(loaded), HasSubstr(message)) << text;
    EXPECT_EQ(loaded.diagnostics.front().location.line, 5U) << text;
    EXPECT_GE(loaded.diagnostics.front().location.column, 11U) << text;
  }
}

}  // namespace
}  // namespace cluxel::testing
