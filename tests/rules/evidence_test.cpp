// SPDX-License-Identifier: Apache-2.0
// Evidence: curves, bells and tests add log-odds; rules of one stratum compete by their sums.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rules/box_world.hpp"
#include "rules/explain/explain.hpp"
#include "rules/propose/evidence.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

const std::string kRivals = R"(
  - id: sign/any
    class: clx:StreetSign
    seed: { label: column, as: pole }
    evidence:
      - { attribute: height, curve: { 2 m: 2, 4 m: -2 } }
      - { of: plate, attribute: height, about: 0.6 m, spread: 0.2 m, weight: 1.5, missing: -0.5 }
    tree:
      find: { as: plate, label: vertical_plane, where: [ { gap_to: pole, op: "<=", value: 0.3 m } ] }
      found: { accept: { parts: { pole: clx:SignPole, plate: clx:SignPlate }, confidence: 0.5 } }
      missing: { accept: { part: clx:SignPole, confidence: 0.5 } }
  - id: lamp/any
    class: clx:StreetLamp
    seed: { label: column, as: pole }
    evidence:
      - { attribute: height, curve: { 2 m: -2, 4 m: 2 } }
      - { when: { attribute: horizontal_extent, op: ">=", value: 1 m }, weight: -3 }
    tree:
      test: { attribute: height, op: ">=", value: 1 m }
      yes: { accept: { part: clx:LampPole, confidence: 0.5 } }
      no: { reject: low }
)";

BoxScene twoPoles() {
  BoxScene scene;
  scene.boxes = {box("short", kColumn, {0, 0, 1.1}, {0.1, 0.1, 2.2}), box("tall", kColumn, {9, 0, 2.5}, {0.1, 0.1, 5})};
  return scene;
}

TEST(Evidence, DecidesBetweenClassesOfOneStratum) {
  const BuiltBoxScene built = sceneOfBoxes(twoPoles());
  EXPECT_THAT(inWords(built, reason(built.scene, rulesOf("[[clx:StreetSign, clx:StreetLamp]]", kRivals))),
              ::testing::ElementsAre("StreetLamp{LampPole: tall}", "StreetSign{SignPole: short}"));
  EXPECT_THAT(inWords(built, reason(built.scene, rulesOf("[[clx:StreetLamp, clx:StreetSign]]", kRivals))),
              ::testing::ElementsAre("StreetLamp{LampPole: tall}", "StreetSign{SignPole: short}"));
}

TEST(Evidence, OfEarlierStrataTakesFirst) {
  const BuiltBoxScene built = sceneOfBoxes(twoPoles());
  EXPECT_THAT(inWords(built, reason(built.scene, rulesOf("[clx:StreetSign, clx:StreetLamp]", kRivals))),
              ::testing::ElementsAre("StreetSign{SignPole: short}", "StreetSign{SignPole: tall}"));
}

TEST(Evidence, IsInterpolatedOnCurvesAndConstantBeyondTheirEnds) {
  EvidenceLine line;
  line.knots = {{1, -1, {}}, {3, 1, {}}, {4, 0, {}}};
  EXPECT_DOUBLE_EQ(logOddsOf(line, 0), -1);
  EXPECT_DOUBLE_EQ(logOddsOf(line, 2), 0);
  EXPECT_DOUBLE_EQ(logOddsOf(line, 3.5), 0.5);
  EXPECT_DOUBLE_EQ(logOddsOf(line, 9), 0);
  line.kind = EvidenceLine::Kind::Bell;
  line.about = 2, line.spread = 0.5, line.weight = 3;
  EXPECT_DOUBLE_EQ(logOddsOf(line, 2), 3);
  EXPECT_NEAR(logOddsOf(line, 2.5), 3 * std::exp(-0.5), 1e-12);
}

TEST(Evidence, AddsUpToTheObjectsConfidence) {
  const BuiltBoxScene built = sceneOfBoxes(twoPoles());
  const ReasoningResult result = reason(built.scene, rulesOf("[[clx:StreetSign, clx:StreetLamp]]", kRivals));
  for (const SemanticObject& object : result.objects) {
    const Decision& decision = result.decisions[object.decision];
    double sum = 0;
    for (const EvidenceStep& step : decision.evidence) sum += step.log_odds;
    EXPECT_NEAR(sum, decision.log_odds, 1e-12);
    EXPECT_NEAR(object.confidence, 1 / (1 + std::exp(-sum)), 1e-12);
    ASSERT_EQ(decision.rivals.size(), 1U);
    EXPECT_FALSE(decision.rivals.front().won);
  }
}

TEST(Evidence, OfWhatIsNotBoundCountsAsMissing) {
  const BuiltBoxScene built = sceneOfBoxes(twoPoles());
  const ReasoningResult result = reason(built.scene, rulesOf("[[clx:StreetSign, clx:StreetLamp]]", kRivals));
  const auto sign = std::find_if(result.objects.begin(), result.objects.end(),
                                 [](const SemanticObject& object) { return object.rule_id == "sign/any"; });
  ASSERT_NE(sign, result.objects.end());
  const auto& evidence = result.decisions[sign->decision].evidence;
  ASSERT_EQ(evidence.size(), 3U);
  EXPECT_FALSE(evidence[2].measured);
  EXPECT_DOUBLE_EQ(evidence[2].log_odds, -0.5);
}

TEST(Evidence, IsExplainedLineByLineWithTheRivals) {
  const BuiltBoxScene built = sceneOfBoxes(twoPoles());
  const RuleSet rules = rulesOf("[[clx:StreetSign, clx:StreetLamp]]", kRivals);
  const auto tall =
      static_cast<PrimitiveIndex>(std::find(built.names.begin(), built.names.end(), "tall") - built.names.begin());
  const std::string text = textOf(explain(built.scene, rules, {}, tall), rules, built.scene);
  EXPECT_THAT(text, ::testing::HasSubstr("+2  height of pole (5 m)"));
  EXPECT_THAT(text, ::testing::HasSubstr("rival: clx:StreetSign (sign/any), log-odds -2.5"));
  EXPECT_THAT(text, ::testing::HasSubstr("the evidence for clx:StreetLamp is stronger"));
}

TEST(Evidence, LeavesWhatIsMoreLikelyNothing) {
  const std::string rules = R"(
  - id: sign/any
    class: clx:StreetSign
    seed: { label: column, as: pole }
    tree:
      test: { attribute: height, op: ">=", value: 1 m }
      yes: { accept: { part: clx:SignPole, confidence: 0.3 } }
      no: { reject: low }
  - id: lamp/never
    class: clx:StreetLamp
    seed: { label: scatter }
    tree:
      test: { attribute: height, op: ">=", value: 90 m }
      yes: { accept: { confidence: 0.3 } }
      no: { reject: low }
)";
  const BuiltBoxScene built = sceneOfBoxes(twoPoles());
  RuleSet strict = rulesOf("[[clx:StreetSign, clx:StreetLamp]]", rules);
  EXPECT_EQ(reason(built.scene, strict).objects.size(), 2U);
  strict.nothing.fill(0);
  EXPECT_TRUE(reason(built.scene, strict).objects.empty());
}

TEST(Evidence, GainsNothingByTheNumberOfPieces) {
  const std::string rules = R"(
  - id: sign/any
    class: clx:StreetSign
    seed: { label: column, as: pole }
    group: { near: 1 m }
    tree:
      test: { attribute: height, op: ">=", value: 1 m }
      yes: { accept: { part: clx:SignPole, confidence: 0.2 } }
      no: { reject: low }
  - id: lamp/never
    class: clx:StreetLamp
    seed: { label: scatter }
    tree:
      test: { attribute: height, op: ">=", value: 90 m }
      yes: { accept: { confidence: 0.3 } }
      no: { reject: low }
)";
  BoxScene scene;
  for (const double z : {0.5, 1.8, 3.1})
    scene.boxes.push_back(box("p" + std::to_string(static_cast<int>(z)), kColumn, {0, 0, z}, {0.1, 0.1, 1}));
  const BuiltBoxScene built = sceneOfBoxes(scene);
  RuleSet set = rulesOf("[[clx:StreetSign, clx:StreetLamp]]", rules);
  set.nothing.fill(-1);  // a chance of 0.27
  EXPECT_TRUE(reason(built.scene, set).objects.empty()) << "three pieces are no likelier a sign than one";
  set.nothing.fill(-1.5);
  EXPECT_EQ(reason(built.scene, set).objects.size(), 1U);
}

TEST(Evidence, DecidesAboutWhatIsLikelyFirst) {
  const std::string rules = R"(
  - id: bush/any
    class: clx:Bush
    seed: { label: scatter, as: leaves }
    group: { near: 1 m }
    tree:
      test: { attribute: height, op: ">=", value: 0.1 m }
      yes: { accept: { confidence: 0.25 } }
      no: { reject: low }
  - id: vehicle/high
    class: clx:Vehicle
    seed: { label: scatter, as: body }
    tree:
      test: { attribute: height, op: ">=", value: 1.2 m }
      yes: { accept: { confidence: 0.6 } }
      no: { reject: low }
)";
  BoxScene scene;
  scene.boxes = {box("high", kScatter, {0, 0, 0.75}, {2, 1, 1.5}), box("low", kScatter, {2, 0, 0.4}, {1, 1, 0.8})};
  const BuiltBoxScene built = sceneOfBoxes(scene);
  RuleSet set = rulesOf("[[clx:Bush, clx:Vehicle]]", rules);
  set.nothing.fill(-2);
  EXPECT_THAT(inWords(built, reason(built.scene, set)),
              ::testing::ElementsAre("Bush{Bush: low}", "Vehicle{Vehicle: high}"));
}

TEST(Evidence, RecordsNoDefeatOfWhatWasOnlyHeldBack) {
  const std::string rules = R"(
  - id: bush/any
    class: clx:Bush
    seed: { label: scatter, as: leaves }
    group: { near: 1 m }
    tree:
      test: { attribute: height, op: ">=", value: 0.1 m }
      yes: { accept: { confidence: 0.25 } }
      no: { reject: low }
  - id: vehicle/high
    class: clx:Vehicle
    seed: { label: scatter, as: body }
    tree:
      test: { attribute: height, op: ">=", value: 1.2 m }
      yes: { accept: { confidence: 0.6 } }
      no: { reject: low }
  - id: person/low
    class: clx:Person
    seed: { label: scatter, as: body }
    tree:
      test: { attribute: height, op: "<=", value: 1 m }
      yes: { accept: { confidence: 0.3 } }
      no: { reject: high }
)";
  BoxScene scene;
  scene.boxes = {box("high", kScatter, {0, 0, 0.75}, {2, 1, 1.5}), box("low", kScatter, {2, 0, 0.4}, {1, 1, 0.8})};
  const BuiltBoxScene built = sceneOfBoxes(scene);
  RuleSet set = rulesOf("[[clx:Bush, clx:Vehicle, clx:Person]]", rules);
  set.nothing.fill(-2);
  const ReasoningResult result = reason(built.scene, set);
  EXPECT_THAT(inWords(built, result), ::testing::ElementsAre("Person{Person: low}", "Vehicle{Vehicle: high}"));
  // The bush competes with both; the person waits for what becomes of it, and loses to nobody.
  for (const Decision& decision : result.decisions) {
    EXPECT_TRUE(decision.accepted || decision.rule_id != "person/low" || decision.reason == "high") << decision.reason;
  }
}

}  // namespace
}  // namespace cluxel::testing
