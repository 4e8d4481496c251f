// SPDX-License-Identifier: Apache-2.0
// Evidence about classes that compete with the rule's own: it reads the winners of the first round, in the second.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "rules/box_world.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

/// High poles are surely lamps. A low one is rather a pole, unless a lamp stands within 30 m of it.
constexpr const char* kLampsInRows = R"(
  - id: lamp/high
    class: clx:StreetLamp
    seed: { label: column, where: [ height >= 6 m ] }
    tree: { accept: { confidence: 0.95 } }
  - id: lamp/low
    class: clx:StreetLamp
    seed: { label: column, where: [ height < 6 m ] }
    evidence:
      - { gap_to: { object: clx:StreetLamp }, curve: { 29 m: 2, 31 m: 0 } }
    tree: { accept: { confidence: 0.3 } }
  - id: pole
    class: clx:Pole
    seed: { label: column }
    tree: { accept: { confidence: 0.5 } }
)";

RuleSet lampsInRows() {
  return rulesOf("[ [clx:StreetLamp, clx:Pole] ]", kLampsInRows);
}

/// Poles of these heights [m], 20 m apart.
BoxScene rowOfPoles(const std::vector<double>& heights) {
  BoxScene boxes;
  for (std::size_t i = 0; i < heights.size(); ++i)
    boxes.boxes.push_back(box(std::string(1, static_cast<char>('a' + i)), kColumn,
                              {20.0 * static_cast<double>(i), 0, heights[i] / 2}, {0.2, 0.2, heights[i]}));
  return boxes;
}

std::vector<std::string> decided(const BoxScene& boxes, const RuleSet& rules) {
  const BuiltBoxScene built = sceneOfBoxes(boxes);
  return inWords(built, reason(built.scene, rules));
}

TEST(TwoRounds, LetANeighbourTipTheBalance) {
  EXPECT_THAT(decided(rowOfPoles({4}), lampsInRows()), ::testing::ElementsAre("Pole{Pole: a}"));
  EXPECT_THAT(decided(rowOfPoles({8, 4}), lampsInRows()),
              ::testing::ElementsAre("StreetLamp{StreetLamp: a}", "StreetLamp{StreetLamp: b}"));
}

TEST(TwoRounds, AreExactlyTwo) {
  EXPECT_THAT(decided(rowOfPoles({8, 4, 4}), lampsInRows()),
              ::testing::ElementsAre("Pole{Pole: c}", "StreetLamp{StreetLamp: a}", "StreetLamp{StreetLamp: b}"))
      << "b is a lamp in the second round, which is too late for c";
}

TEST(TwoRounds, DoNotCountAThingAsItsOwnNeighbour) {
  RuleSet rules = rulesOf("[ [clx:StreetLamp, clx:Pole] ]", R"(
  - id: lamp
    class: clx:StreetLamp
    seed: { label: column }
    evidence:
      - { gap_to: { object: clx:StreetLamp }, curve: { 29 m: -5, 31 m: 0 } }
    tree: { accept: { confidence: 0.9 } }
  - id: pole
    class: clx:Pole
    seed: { label: column }
    tree: { accept: { confidence: 0.5 } }
)");
  EXPECT_THAT(decided(rowOfPoles({8}), rules), ::testing::ElementsAre("StreetLamp{StreetLamp: a}"));
  EXPECT_THAT(decided(rowOfPoles({8, 8}), rules), ::testing::ElementsAre("Pole{Pole: a}", "Pole{Pole: b}"));
}

TEST(TwoRounds, ReadTestsOfGapsToo) {
  const RuleSet rules = rulesOf("[ [clx:StreetLamp, clx:Pole] ]", R"(
  - id: lamp
    class: clx:StreetLamp
    seed: { label: column }
    evidence:
      - { when: { all: [ gap to clx:Pole <= 25 m, height >= 3 m ] }, weight: 3 }
    tree: { accept: { confidence: 0.3 } }
  - id: pole
    class: clx:Pole
    seed: { label: column }
    tree: { accept: { confidence: 0.5 } }
)");
  EXPECT_THAT(decided(rowOfPoles({4, 2}), rules), ::testing::ElementsAre("Pole{Pole: b}", "StreetLamp{StreetLamp: a}"));
}

TEST(TwoRounds, DoNotDependOnTheOrderOfBoxes) {
  BoxScene boxes = rowOfPoles({8, 4, 4, 4, 8, 4, 4, 4, 4, 7});
  const auto expected = decided(boxes, lampsInRows());
  std::mt19937 random(11);
  for (int round = 0; round < 5; ++round) {
    std::shuffle(boxes.boxes.begin(), boxes.boxes.end(), random);
    EXPECT_EQ(decided(boxes, lampsInRows()), expected);
  }
}

TEST(TwoRounds, AreExplainedAndObserved) {
  const BuiltBoxScene built = sceneOfBoxes(rowOfPoles({8, 4}));
  std::size_t observed = 0;
  ReasoningContext context;
  context.onCandidate = [&](const auto&...) { ++observed; };
  const RuleSet rules = lampsInRows();
  const ReasoningResult result = reason(built.scene, rules, context);
  EXPECT_EQ(observed, 4u) << "two lamps and two poles, once each";
  const auto lamp = std::find_if(result.decisions.begin(), result.decisions.end(),
                                 [](const Decision& decision) { return decision.rule_id == "lamp/low"; });
  ASSERT_NE(lamp, result.decisions.end());
  ASSERT_EQ(lamp->evidence.size(), 2u);
  EXPECT_EQ(lamp->evidence[1].text, "gap of seed to a StreetLamp of the first round");
  EXPECT_NEAR(*lamp->evidence[1].measured, 19.8, 0.01);
  EXPECT_NEAR(lamp->evidence[1].log_odds, 2, 1e-9);
}

TEST(TwoRounds, AreForGapsInEvidenceOnly) {
  const auto faultOf = [](const std::string& rule) {
    const LoadedRules loaded = loadText(R"(
apiVersion: cluxel.rules/v1
ruleset: { name: test, version: 1.0.0 }
prefixes: { clx: "https://w3id.org/cluxel/ontology#" }
order: [ [clx:StreetLamp, clx:Pole] ]
rules:
  - id: pole
    class: clx:Pole
    seed: { label: column }
)" + rule);
    return loaded.diagnostics.empty() ? std::string() : loaded.diagnostics.front().message;
  };
  EXPECT_THAT(faultOf(R"(    evidence: [ { when: { near: { object: clx:StreetLamp } }, weight: 1 } ]
    tree: { accept: { confidence: 0.5 } }
)"),
              ::testing::HasSubstr("may measure the gap to it only"));
  EXPECT_THAT(faultOf(R"(    tree:
      test: gap to clx:StreetLamp <= 3 m
      yes: { accept: { confidence: 0.5 } }
      no: { reject: far }
)"),
              ::testing::HasSubstr("is decided together with"));
}

}  // namespace
}  // namespace cluxel::testing
