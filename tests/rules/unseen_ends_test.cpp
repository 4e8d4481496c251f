// SPDX-License-Identifier: Apache-2.0
// Tests of ends that no scan shows: the third answer, its branch in trees, and what makes an end unseen.
#include <gmock/gmock.h>

#include <random>

#include "rules/box_world.hpp"
#include "rules/explain/explain.hpp"
#include "rules/explain/path_tree.hpp"
#include "rules/propose/unseen_ends.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

constexpr double kDegree_rad = 3.14159265358979 / 180;

/// A pole of `height_m` at 10 m from a sensor 2 m above the ground.
BoxScene poleSeen(double height_m, std::vector<BoxView> views) {
  BoxScene boxes;
  boxes.boxes.push_back(box("field", kGroundLabel, {0, 0, 0}, {30, 30, 0.05}));
  boxes.boxes.push_back(box("pole", kColumn, {10, 0, height_m / 2}, {0.1, 0.1, height_m}));
  boxes.views = std::move(views);
  return boxes;
}

const BoxView kUnlimited{{0, 0, 2}, std::nullopt};
const BoxView kUpToTwoDegrees{{0, 0, 2}, 2 * kDegree_rad};  // 2.35 m high at 10 m

/// A high pole is a lamp, a low one a sign, one whose top was not seen a pole.
RuleSet rulesOfPoles(const std::string& test) {
  return rulesOf("[clx:StreetLamp, clx:StreetSign, clx:Pole]", R"(
  - id: lamp
    class: clx:StreetLamp
    seed: { label: column }
    tree:
      test: )" + test + R"(
      yes: { accept: { confidence: 0.9 } }
      unseen: { reject: its top was not seen }
      no: { reject: too low }
  - id: pole
    class: clx:Pole
    seed: { label: column }
    tree: { accept: { confidence: 0.5 } }
)");
}

std::string reasonOf(const BoxScene& boxes, const RuleSet& rules) {
  const BuiltBoxScene built = sceneOfBoxes(boxes);
  for (const Decision& decision : reason(built.scene, rules).decisions)
    if (decision.rule_id == "lamp") return decision.accepted ? "accepted" : decision.reason;
  return "no decision";
}

TEST(UnseenEnd, TakesItsOwnBranch) {
  const RuleSet rules = rulesOfPoles("top >= 4 m");
  EXPECT_EQ(reasonOf(poleSeen(5, {kUnlimited}), rules), "accepted");
  EXPECT_EQ(reasonOf(poleSeen(2.35, {kUnlimited}), rules), "too low");
  EXPECT_EQ(reasonOf(poleSeen(2.35, {kUpToTwoDegrees}), rules), "its top was not seen");
}

TEST(UnseenEnd, DoesNotMatterWhereALongerThingWouldGetTheSameAnswer) {
  EXPECT_EQ(reasonOf(poleSeen(2.35, {kUpToTwoDegrees}), rulesOfPoles("top >= 2 m")), "accepted");
  EXPECT_EQ(reasonOf(poleSeen(2.35, {kUpToTwoDegrees}), rulesOfPoles("top <= 2 m")), "too low");
  EXPECT_EQ(reasonOf(poleSeen(2.35, {kUpToTwoDegrees}), rulesOfPoles("top <= 3 m")), "its top was not seen");
  EXPECT_EQ(reasonOf(poleSeen(2.35, {kUpToTwoDegrees}), rulesOfPoles("top between 2 m and 3 m")),
            "its top was not seen");
  EXPECT_EQ(reasonOf(poleSeen(2.35, {kUpToTwoDegrees}), rulesOfPoles("top between 1 m and 2 m")), "too low");
  EXPECT_EQ(reasonOf(poleSeen(2.35, {kUpToTwoDegrees}), rulesOfPoles("height >= 3 m")), "its top was not seen");
}

TEST(UnseenEnd, IsSeenAsSoonAsOneScanShowsIt) {
  const RuleSet rules = rulesOfPoles("top >= 4 m");
  EXPECT_EQ(reasonOf(poleSeen(2.35, {kUpToTwoDegrees, {{0, 1, 2}, 2 * kDegree_rad}}), rules), "its top was not seen");
  EXPECT_EQ(reasonOf(poleSeen(2.35, {kUpToTwoDegrees, {{-40, 0, 2}, 2 * kDegree_rad}}), rules), "too low");
  EXPECT_EQ(reasonOf(poleSeen(2.35, {}), rules), "too low") << "nothing is known of any sensor";
}

TEST(UnseenEnd, IsSeenWhereAScanOfUnknownPlaceSawMoreThanTheOthersCan) {
  const RuleSet rules = rulesOfPoles("top between 1 m and 6 m");
  EXPECT_EQ(reasonOf(poleSeen(5, {kUpToTwoDegrees}), rules), "accepted") << "the known field of view ends at 2.35 m";
  const BoxView cut{{0, 1, 2}, 17 * kDegree_rad};  // 5.06 m high at 10 m
  EXPECT_EQ(reasonOf(poleSeen(5, {kUpToTwoDegrees, cut}), rules), "its top was not seen");
}

TEST(UnseenEnd, OfAllTheLeastTrueCountsAndOfAnyTheMostTrue) {
  const BoxScene boxes = poleSeen(2.35, {kUpToTwoDegrees});
  const auto reasonWith = [&](const std::string& condition) {
    RuleSet rules = rulesOf("[clx:StreetLamp]", R"(
  - id: lamp
    class: clx:StreetLamp
    seed: { label: column }
    tree:
      )" + condition + R"(
      yes: { accept: { confidence: 0.9 } }
      unseen: { reject: unseen }
      no: { reject: "no" }
)");
    return reasonOf(boxes, rules);
  };
  EXPECT_EQ(reasonWith("all: [ top >= 4 m, width <= 1 m ]"), "unseen");
  EXPECT_EQ(reasonWith("all: [ top >= 4 m, width >= 1 m ]"), "no");
  EXPECT_EQ(reasonWith("any: [ top >= 4 m, width <= 1 m ]"), "accepted");
  EXPECT_EQ(reasonWith("any: [ top >= 4 m, width >= 1 m ]"), "unseen");
  EXPECT_EQ(reasonWith("not: top >= 4 m"), "unseen");
  EXPECT_EQ(reasonWith("not: { all: [ top >= 4 m, width >= 1 m ] }"), "accepted");
}

/// A pole whose lower part is missing, and a car between it and the sensor.
BoxScene poleBehind(double car_x_m) {
  BoxScene boxes;
  boxes.boxes.push_back(box("field", kGroundLabel, {0, 0, 0}, {30, 30, 0.05}));
  boxes.boxes.push_back(box("pole", kColumn, {10, 0, 3}, {0.1, 0.1, 3}));
  boxes.boxes.push_back(box("car", kSmall, {car_x_m, 0, 0.75}, {2, 4, 1.5}));
  boxes.views = {kUnlimited};
  return boxes;
}

bool isUnseen(const BoxScene& boxes, const std::string& name, Attribute attribute) {
  const BuiltBoxScene built = sceneOfBoxes(boxes);
  const RuleSet rules = rulesOfPoles("top >= 4 m");
  const ReasoningContext context;
  const ReasoningState state(built.scene, rules, context);
  for (PrimitiveIndex i = 0; i < built.names.size(); ++i)
    if (built.names[i] == name)
      return isEndUnseen(state, state.fragments.candidateOf(state.fragments.fragmentsOf(i)), attribute);
  ADD_FAILURE() << "no box " << name;
  return false;
}

TEST(UnseenEnd, OfAFootIsWhatACarHides) {
  EXPECT_TRUE(isUnseen(poleBehind(8), "pole", Attribute::Bottom));
  EXPECT_TRUE(isUnseen(poleBehind(8), "pole", Attribute::Height));
  EXPECT_FALSE(isUnseen(poleBehind(8), "pole", Attribute::Top));
  EXPECT_FALSE(isUnseen(poleBehind(13), "pole", Attribute::Bottom)) << "the car is behind the pole";
  EXPECT_FALSE(isUnseen(poleBehind(3), "pole", Attribute::Bottom)) << "the ray passes above the car";
  BoxScene low = poleBehind(8);
  low.boxes[1] = box("pole", kColumn, {10, 0, 1.6}, {0.1, 0.1, 2.8});
  EXPECT_FALSE(isUnseen(low, "pole", Attribute::Bottom)) << "a thing that stands on the ground ends there";
}

TEST(UnseenEnd, OfASideIsWhatSomethingBeforeItHides) {
  BoxScene boxes;
  boxes.boxes.push_back(box("van", kSmall, {10, 0, 1}, {1.8, 5, 2}));
  boxes.boxes.push_back(box("hedge", kScatter, {7, 3, 1.5}, {0.5, 3, 3}));
  boxes.views = {kUnlimited};
  EXPECT_TRUE(isUnseen(boxes, "van", Attribute::Length));
  boxes.boxes[1].center.y() = 6;
  EXPECT_FALSE(isUnseen(boxes, "van", Attribute::Length));
  boxes.boxes[1].center.y() = 0;
  EXPECT_FALSE(isUnseen(boxes, "van", Attribute::Length)) << "its middle is hidden, and both ends are seen";
}

TEST(UnseenEnd, DoesNotDependOnTheOrderOfViewsAndBoxes) {
  BoxScene boxes = poleBehind(8);
  boxes.views.push_back({{0, 6, 2}, 1 * kDegree_rad});
  std::mt19937 random(2);
  const bool expected = isUnseen(boxes, "pole", Attribute::Bottom);
  for (int round = 0; round < 5; ++round) {
    std::shuffle(boxes.boxes.begin(), boxes.boxes.end(), random);
    std::shuffle(boxes.views.begin(), boxes.views.end(), random);
    EXPECT_EQ(isUnseen(boxes, "pole", Attribute::Bottom), expected);
  }
}

TEST(UnseenEnd, OfALowerThingWouldStillBeUnseen) {
  const RuleSet rules = rulesOf("[clx:StreetLamp]", R"(
  - id: lamp
    class: clx:StreetLamp
    seed: { label: column }
    tree:
      test: top >= 1.9 m
      yes: { accept: { confidence: 0.9 } }
      unseen: { accept: { confidence: 0.7 } }
      no: { reject: too low }
)");
  for (const bool shown : {true, false}) {
    const BuiltBoxScene built = sceneOfBoxes(poleSeen(2.35, {shown ? kUnlimited : kUpToTwoDegrees}));
    const ReasoningResult result = reason(built.scene, rules);
    ASSERT_EQ(result.objects.size(), 1u);
    const Explanation explanation = explain(built.scene, rules, {}, result.decisions.front().seed);
    ASSERT_EQ(explanation.decisions.size(), 1u);
    EXPECT_EQ(explanation.decisions.front().counterfactual.has_value(), shown)
        << "a top of 1.9 m that no scan shows is accepted, too";
  }
}

TEST(UnseenEnd, IsToldByExplanations) {
  const BuiltBoxScene built = sceneOfBoxes(poleSeen(2.35, {kUpToTwoDegrees}));
  const RuleSet rules = rulesOfPoles("top >= 4 m");
  const ReasoningResult result = reason(built.scene, rules);
  const auto decision = std::find_if(result.decisions.begin(), result.decisions.end(),
                                     [](const Decision& d) { return d.rule_id == "lamp"; });
  ASSERT_NE(decision, result.decisions.end());
  ASSERT_EQ(decision->path.size(), 1u);
  EXPECT_EQ(decision->path.front().test, "unseen: top of seed >= 4 m");
  EXPECT_TRUE(decision->path.front().passed);
  EXPECT_NEAR(*decision->path.front().measured, 2.35, 0.01);
  EXPECT_THAT(dotOf(rules.rules.front(), *decision), ::testing::HasSubstr("unseen: top of seed >= 4 m"));
}

TEST(UnseenEnd, IsRefusedOfTestsThatMeasureNone) {
  for (const char* test : {"roughness <= 0.1 m", "is column", "length from 1 m to 2 m >= 1 m", "width >= 1 m"}) {
    const LoadedRules loaded = loadText(std::string(R"(
apiVersion: cluxel.rules/v1
ruleset: { name: test, version: 1.0.0 }
prefixes: { clx: "https://w3id.org/cluxel/ontology#" }
order: [clx:Pole]
rules:
  - id: pole
    class: clx:Pole
    seed: { label: column }
    tree:
      test: )") + test + R"(
      yes: { accept: { confidence: 0.9 } }
      unseen: { reject: unseen }
      no: { reject: "no" }
)");
    ASSERT_FALSE(loaded.diagnostics.empty()) << test;
    EXPECT_THAT(loaded.diagnostics.front().message, ::testing::HasSubstr("never unseen")) << test;
  }
}

}  // namespace
}  // namespace cluxel::testing
