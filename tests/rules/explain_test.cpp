// SPDX-License-Identifier: Apache-2.0
// Explanations: the path, the rejections, and counterfactuals that hold when applied.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "rules/box_world.hpp"
#include "rules/explain/explain.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

RuleSet poleRules() {
  return rulesOf("[clx:UtilityPole, clx:SmallObject]", R"(
  - id: pole/tall
    class: clx:UtilityPole
    seed: { label: column, as: pole }
    tree:
      all:
        - { attribute: height, op: ">=", value: 6 m }
        - { attribute: bottom, op: "<=", value: 0.5 m }
      yes: { accept: { part: clx:PoleMast, confidence: 0.8 } }
      no: { reject: not tall, hint: small/rest }
  - id: small/rest
    class: clx:SmallObject
    seed: { label: column }
    tree:
      test: { attribute: volume, op: "<=", value: 4 m3 }
      yes: { accept: { confidence: 0.6 } }
      no: { reject: too big }
)");
}

BuiltBoxScene poleOf(double height) {
  BoxScene scene;
  scene.boxes = {box("pole", kColumn, {0, 0, height / 2}, {0.3, 0.3, height})};
  return sceneOfBoxes(scene);
}

TEST(Explaining, PutsTheArticleThatIsSpoken) {
  EXPECT_EQ(withArticle("Tree"), "a Tree");
  EXPECT_EQ(withArticle("Avenue"), "an Avenue");
  EXPECT_EQ(withArticle("Umbrella"), "an Umbrella");
  EXPECT_EQ(withArticle("UtilityPole"), "a UtilityPole");
  EXPECT_EQ(withArticle("column"), "a column");
}

TEST(Explaining, GivesTheWayWithMeasuresThresholdsAndMargins) {
  const BuiltBoxScene built = poleOf(5);
  const RuleSet rules = poleRules();
  const Explanation explanation = explain(built.scene, rules, {}, 0);
  ASSERT_EQ(explanation.decisions.size(), 2U);
  ASSERT_TRUE(explanation.object.has_value());
  EXPECT_EQ(explanation.object->class_iri, clx("SmallObject"));
  const Decision& no_pole = explanation.decisions[0].decision;
  ASSERT_EQ(no_pole.path.size(), 2U);
  EXPECT_FALSE(no_pole.path[0].passed);
  EXPECT_NEAR(*no_pole.path[0].measured, 5.0, 1e-6);
  EXPECT_DOUBLE_EQ(*no_pole.path[0].threshold, 6.0);
  EXPECT_EQ(no_pole.path[0].test, "height of pole >= 6 m");
  EXPECT_TRUE(no_pole.path[1].passed);
}

TEST(Explaining, NamesALeastChangeThatTurnsTheVerdictWhenTried) {
  const RuleSet rules = poleRules();
  const Explanation before = explain(poleOf(5).scene, rules, {}, 0);
  ASSERT_TRUE(before.decisions[0].counterfactual.has_value());
  const Counterfactual& change = *before.decisions[0].counterfactual;
  EXPECT_TRUE(change.accepted);
  ASSERT_EQ(change.changes.size(), 1U);
  EXPECT_NEAR(change.changes[0].margin, 1.0, 1e-6);
  const ReasoningResult after = reason(poleOf(change.changes[0].threshold).scene, rules);
  ASSERT_EQ(after.objects.size(), 1U);
  EXPECT_EQ(after.objects[0].class_iri, clx("UtilityPole"));
}

/// What the least change for a pole of 5 m is said to lead to; empty: nothing is offered.
std::string leastChange(const std::string& order, const std::string& rules_text) {
  const RuleSet rules = rulesOf(order, rules_text);
  const Explanation explanation = explain(poleOf(5).scene, rules, {}, 0);
  if (explanation.decisions.empty() || !explanation.decisions[0].counterfactual) return "";
  return explanation.decisions[0].counterfactual->outcome;
}

TEST(Explaining, WalksTheWholeTreeWithTheChangedValue) {
  const auto treeOf = [](const std::string& above_6_m) {
    return R"(
  - id: pole/tall
    class: clx:Pole
    seed: { label: column }
    tree:
      test: height >= 6 m
      yes:
        )" +
           above_6_m + R"(
        yes: { accept: { confidence: 0.8 } }
        no: { reject: none }
      no: { reject: low }
)";
  };
  EXPECT_EQ(leastChange("[clx:Pole]", treeOf("all: [ height >= 5.5 m, bottom <= 1 m ]")), "clx:Pole")
      << "6 m are also above 5.5 m";
  EXPECT_EQ(leastChange("[clx:Pole]", treeOf("any: [ height <= 5.5 m, bottom >= 1 m ]")), "")
      << "6 m are no longer below 5.5 m";
}

TEST(Explaining, OffersNoChangeAfterWhichTheEvidenceSpeaksAgainstTheThing) {
  const auto rulesWith = [](const std::string& evidence) {
    return R"(
  - id: pole/tall
    class: clx:Pole
    seed: { label: column, as: pole }
    evidence: [ )" +
           evidence + R"( ]
    tree:
      test: height >= 6 m
      yes: { accept: { confidence: 0.5 } }
      no: { reject: low }
  - id: lamp/flat
    class: clx:StreetLamp
    seed: { label: column }
    tree:
      test: height <= 1 m
      yes: { accept: { confidence: 0.5 } }
      no: { reject: high }
)";
  };
  for (const std::string order : {"[clx:Pole, clx:StreetLamp]", "[[clx:Pole, clx:StreetLamp]]"}) {
    EXPECT_EQ(leastChange(order, rulesWith("{ when: bottom <= 1 m, weight: 2 }")), "clx:Pole") << order;
    EXPECT_EQ(leastChange(order, rulesWith("{ when: bottom <= 1 m, weight: -9 }")), "") << order;
    EXPECT_EQ(leastChange(order, rulesWith("{ when: height <= 5.5 m, weight: -9 }")), "clx:Pole")
        << order << ": this line does not hold at 6 m";
    EXPECT_EQ(leastChange(order, rulesWith("{ attribute: height, curve: { 5 m: 2, 5.9 m: -9 } }")), "") << order;
  }
}

/// A post of three columns, 5 m high, where it costs `nothing` to leave a column without an object: what the least
/// change leads to, or why there is none.
std::string leastChangeOfGroup(double nothing) {
  RuleSet rules = rulesOf("[[clx:Pole, clx:StreetLamp]]", R"(
  - id: pole/tall
    class: clx:Pole
    seed: { label: column, as: pole }
    group: { near: 1 m }
    tree:
      test: height >= 6 m
      yes: { accept: { confidence: 0.9 } }
      no: { reject: low }
  - id: lamp/flat
    class: clx:StreetLamp
    seed: { label: scatter }
    tree:
      test: height <= 1 m
      yes: { accept: { confidence: 0.5 } }
      no: { reject: high }
)");
  rules.nothing.fill(nothing);
  const auto postOf = [](double height) {
    BoxScene scene;
    for (const double x : {0.0, 0.5, 1.0})
      scene.boxes.push_back(box("p" + std::to_string(x), kColumn, {x, 0, height / 2}, {0.3, 0.3, height}));
    return sceneOfBoxes(scene);
  };
  const BuiltBoxScene low = postOf(5), high = postOf(6.5);
  const Explanation explanation = explain(low.scene, rules, {}, 0);
  const auto& change = explanation.decisions.at(0).counterfactual;
  EXPECT_EQ(change.has_value() && change->accepted, !reason(high.scene, rules).objects.empty())
      << "what is offered comes out";
  return change ? change->outcome : "none";
}

TEST(Explaining, OffersNoChangeToAGroupThatIsLikelierNothing) {
  EXPECT_EQ(leastChangeOfGroup(-3), "clx:Pole");
  EXPECT_EQ(leastChangeOfGroup(0.5), "clx:Pole") << "log-odds of 2.2 are more than three times 0.5";
  EXPECT_EQ(leastChangeOfGroup(1.5), "none") << "they are more than 1.5, but less than three times 1.5";
}

TEST(Explaining, CountsAThingThatIsNoLongerASeedAsLost) {
  const RuleSet rules = rulesOf("[clx:Pole]", R"(
  - id: pole/tall
    class: clx:Pole
    seed: { label: column, where: [ { any: [ height >= 4 m, bottom >= 1 m ] } ] }
    tree:
      test: height >= 3 m
      yes: { accept: { confidence: 0.5 } }
      no: { accept: { confidence: 0.4 } }
)");
  const Explanation explanation = explain(poleOf(5).scene, rules, {}, 0);
  ASSERT_TRUE(explanation.decisions.at(0).counterfactual.has_value());
  EXPECT_FALSE(explanation.decisions[0].counterfactual->accepted);
  EXPECT_EQ(explanation.decisions[0].counterfactual->outcome, "it is no seed of the rule");
}

TEST(Explaining, SaysHowAnAcceptedThingWouldBeLost) {
  const Explanation explanation = explain(poleOf(6.1).scene, poleRules(), {}, 0);
  ASSERT_EQ(explanation.decisions.size(), 1U);
  ASSERT_TRUE(explanation.decisions[0].counterfactual.has_value());
  EXPECT_FALSE(explanation.decisions[0].counterfactual->accepted);
  EXPECT_NEAR(explanation.decisions[0].counterfactual->changes[0].margin, 0.1, 1e-6);
}

TEST(Explaining, MeasuresPairsFromTheNearerEndOfAnInterval) {
  const RuleSet rules = rulesOf("[clx:Tree, clx:SmallObject]", R"(
  - id: tree/t
    class: clx:Tree
    seed: { label: column, as: a }
    tree:
      find: { as: b, label: scatter, where: [ { gap_to: a, op: "<=", value: 3 m } ] }
      found:
        test: { of: b, gap_to: a, op: between, min: 0.1 m, max: 0.5 m }
        yes: { accept: { confidence: 0.5 } }
        no: { reject: not beside }
      missing: { reject: alone }
)");
  BoxScene scene;
  scene.boxes = {box("a", kColumn, {0, 0, 1}, {0.3, 0.3, 2}), box("b", kScatter, {1.5, 0, 1}, {1, 1, 2})};
  const Explanation explanation =
      explain(sceneOfBoxes(scene).scene, rules, {}, sceneOfBoxes(scene).scene.primitives[0].label == kColumn ? 0 : 1);
  ASSERT_FALSE(explanation.decisions.empty());
  ASSERT_TRUE(explanation.decisions[0].counterfactual.has_value());
  const NeededChange& change = explanation.decisions[0].counterfactual->changes.at(0);
  EXPECT_DOUBLE_EQ(change.threshold, 0.5);
  EXPECT_NEAR(change.margin, change.measured - 0.5, 1e-9);
}

TEST(Explaining, ReadsAsText) {
  const BuiltBoxScene built = poleOf(5);
  const RuleSet rules = poleRules();
  const std::string text = textOf(explain(built.scene, rules, {}, 0), rules, built.scene);
  EXPECT_THAT(text, ::testing::HasSubstr("belongs to clx:SmallObject"));
  EXPECT_THAT(text, ::testing::HasSubstr("no   height of pole >= 6 m (measured 5 m, margin 1 m)"));
  EXPECT_THAT(text,
              ::testing::HasSubstr(
                  "least change: height of pole >= 6 m turns at 6 m (now 5 m); then the rule says: clx:UtilityPole"));
  EXPECT_THAT(text, ::testing::HasSubstr("see also rule small/rest"));
}

TEST(Explaining, IsJsonToo) {
  const BuiltBoxScene built = poleOf(5);
  const RuleSet rules = poleRules();
  const auto json = nlohmann::json::parse(jsonOf(explain(built.scene, rules, {}, 0), rules, built.scene));
  EXPECT_EQ(json.at("object").at("class"), "clx:SmallObject");
  EXPECT_EQ(json.at("decisions").at(0).at("path").at(0).at("threshold"), 6.0);
}

TEST(Explaining, TellsHowAFoundPrimitiveGotToItsObject) {
  const BuiltBoxScene built = sceneOfBoxes(streetOfBoxes());
  const RuleSet rules = outdoorRules();
  const auto plate = static_cast<PrimitiveIndex>(std::find(built.names.begin(), built.names.end(), "sign_plate") -
                                                 built.names.begin());
  const Explanation explanation = explain(built.scene, rules, {}, plate);
  ASSERT_TRUE(explanation.object.has_value());
  EXPECT_EQ(explanation.object->class_iri, clx("StreetSign"));
  EXPECT_FALSE(explanation.note.empty());
}

}  // namespace
}  // namespace cluxel::testing
