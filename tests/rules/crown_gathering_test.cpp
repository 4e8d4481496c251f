// SPDX-License-Identifier: Apache-2.0
// Fragments beside split crowns go to the nearest trunk, cluxel by cluxel, with a recorded reason.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "rules/box_world.hpp"
#include "rules/explain/explain.hpp"
#include "rules/explain/path_tree.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

RuleSet gatheringRules(const std::string& gather, const std::string& order = "[clx:Tree]") {
  return rulesOf(order, R"(
  - id: tree/any
    class: clx:Tree
    seed: { label: column, as: trunk }
    tree:
      find: { as: top, label: scatter, share: true, choose: all, where: [ { gap_to: trunk, op: "<=", value: 0.6 m } ] }
      found:
        accept:
          parts: { trunk: clx:TreeTrunk, top: clx:TreeTop }
          confidence: 0.9
          split: { shared: top, from: trunk, reach: 6 m, jump: 0.5 m)" +
                            gather + R"( }
      missing: { reject: no crown }
)");
}
const std::string kGather = ", gather: { within: 1.2 m, above: 1.5 m }";

/// Two trees 8 m apart. Between them a row of leaves that touches neither crown, a clump under the left crown, and a
/// clump out of reach.
BoxScene twoTrees() {
  BoxScene scene;
  scene.boxes = {box("trunk_a", kColumn, {-4, 0, 1.5}, {0.4, 0.4, 3}),
                 box("trunk_b", kColumn, {4, 0, 1.5}, {0.4, 0.4, 3}),
                 box("crown_a", kScatter, {-4, 0, 4.5}, {3, 3, 3}),
                 box("crown_b", kScatter, {4, 0, 4.5}, {3, 3, 3}),
                 box("beam", kScatter, {0, 0, 5}, {3.4, 0.6, 0.6}),
                 box("low", kScatter, {-4, 2.2, 0.7}, {1, 1, 1.4}),
                 box("far", kScatter, {0, 9, 5}, {1, 1, 1})};
  return scene;
}

std::vector<double> plansOf(const BuiltBoxScene& built, const SemanticObject& object, const std::string& name) {
  const auto index =
      static_cast<PrimitiveIndex>(std::find(built.names.begin(), built.names.end(), name) - built.names.begin());
  std::vector<double> plans;
  for (const ObjectPart& part : object.parts)
    for (std::uint32_t cluxel : part.cluxels)
      if (built.scene.cluxels.primitive[cluxel] == index) plans.push_back(built.scene.cluxels.center[cluxel].x());
  return plans;
}

TEST(CrownGathering, CutsAFragmentBetweenTwoTreesAtTheMiddle) {
  const BuiltBoxScene built = sceneOfBoxes(twoTrees());
  const ReasoningResult result = reason(built.scene, gatheringRules(kGather));
  EXPECT_THAT(inWords(built, result),
              ::testing::UnorderedElementsAre("Tree{TreeTop: beam crown_a; TreeTrunk: trunk_a}",
                                              "Tree{TreeTop: beam crown_b; TreeTrunk: trunk_b}"));
  for (const SemanticObject& object : result.objects) {
    const std::vector<double> beam = plansOf(built, object, "beam");
    const bool is_left = !plansOf(built, object, "trunk_a").empty();
    ASSERT_FALSE(beam.empty());
    for (double x : beam) EXPECT_TRUE(is_left ? x <= 0.01 : x >= -0.01) << x;
  }
}

TEST(CrownGathering, HappensInAStratumThatBeginsWithAnotherClass) {
  const BuiltBoxScene built = sceneOfBoxes(twoTrees());
  EXPECT_EQ(inWords(built, reason(built.scene, gatheringRules(kGather, "[[clx:UtilityPole, clx:Tree]]"))),
            inWords(built, reason(built.scene, gatheringRules(kGather))));
}

TEST(CrownGathering, HappensOnlyWhereTheRuleAsksForIt) {
  const BuiltBoxScene built = sceneOfBoxes(twoTrees());
  EXPECT_THAT(inWords(built, reason(built.scene, gatheringRules(""))),
              ::testing::UnorderedElementsAre("Tree{TreeTop: crown_a; TreeTrunk: trunk_a}",
                                              "Tree{TreeTop: crown_b; TreeTrunk: trunk_b}"));
}

TEST(CrownGathering, FollowsFromFragmentToFragmentWithinTheReach) {
  BoxScene scene = twoTrees();
  scene.boxes.resize(4);
  scene.boxes.push_back(box("first", kScatter, {-7, 0, 5}, {1, 1, 1}));
  scene.boxes.push_back(box("second", kScatter, {-9, 0, 5}, {1, 1, 1}));
  scene.boxes.push_back(box("third", kScatter, {-11, 0, 5}, {1, 1, 1}));  // beyond 6 m from the trunk
  const BuiltBoxScene built = sceneOfBoxes(scene);
  EXPECT_THAT(inWords(built, reason(built.scene, gatheringRules(kGather))),
              ::testing::UnorderedElementsAre("Tree{TreeTop: crown_a first second; TreeTrunk: trunk_a}",
                                              "Tree{TreeTop: crown_b; TreeTrunk: trunk_b}"));
}

TEST(CrownGathering, DoesNotDependOnTheOrderOfBoxes) {
  const RuleSet rules = gatheringRules(kGather);
  BoxScene scene = twoTrees();
  const ReasoningResult expected = reason(sceneOfBoxes(scene).scene, rules);
  std::mt19937 random(3);
  for (int round = 0; round < 5; ++round) {
    std::shuffle(scene.boxes.begin(), scene.boxes.end(), random);
    const ReasoningResult result = reason(sceneOfBoxes(scene).scene, rules);
    ASSERT_EQ(result.objects.size(), expected.objects.size());
    for (std::size_t i = 0; i < result.objects.size(); ++i) EXPECT_EQ(result.objects[i].id, expected.objects[i].id);
  }
}

/// Two trees with hanging leaves all around, which follow from each other.
BoxScene treesAmongLeaves(std::mt19937& random) {
  BoxScene scene = twoTrees();
  const auto within = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d centre(within(-8, 8), within(-5, 5), within(2, 7)), size(within(0.4, 1), within(0.4, 1), 0.4);
    scene.boxes.push_back(box("leaves" + std::to_string(i), kScatter, centre, size));
  }
  return scene;
}

TEST(CrownGathering, DoesNotDependOnTheNumberOfThreads) {
  const RuleSet rules = gatheringRules(kGather);
  std::mt19937 random(4);
  std::size_t gathered = 0;
  for (int round = 0; round < 8; ++round) {
    const Scene scene = sceneOfBoxes(treesAmongLeaves(random)).scene;
    const ReasoningResult expected = reason(scene, rules);
    for (const unsigned threads : {2U, 3U}) {
      const ReasoningResult result = reason(scene, rules, {.threads = threads});
      EXPECT_EQ(result.traces, expected.traces);
      ASSERT_EQ(result.objects.size(), expected.objects.size());
      for (std::size_t i = 0; i < result.objects.size(); ++i) EXPECT_EQ(result.objects[i].id, expected.objects[i].id);
    }
    for (const Decision& decision : expected.decisions) gathered += decision.is_gathered ? 1 : 0;
  }
  EXPECT_GT(gathered, 50U);
}

TEST(CrownGathering, IsToldByExplain) {
  const BuiltBoxScene built = sceneOfBoxes(twoTrees());
  const RuleSet rules = gatheringRules(kGather);
  const auto beam =
      static_cast<PrimitiveIndex>(std::find(built.names.begin(), built.names.end(), "beam") - built.names.begin());
  const std::string text = textOf(explain(built.scene, rules, {}, beam), rules, built.scene);
  EXPECT_THAT(text, ::testing::HasSubstr("gathered into top of the clx:Tree whose trunk is nearest in plan view"));
  EXPECT_THAT(text, ::testing::HasSubstr("gap to the object <= gather's `within` (measured"));
  const ReasoningResult result = reason(built.scene, rules);
  for (const Decision& decision : result.decisions)
    EXPECT_EQ(walkedPath(rules.rules.front(), decision).empty(), decision.is_gathered);
}

}  // namespace
}  // namespace cluxel::testing
