// SPDX-License-Identifier: Apache-2.0
// What lies near is found, and changes near a seed are noticed: against all pairs.
#include "rules/decide/rule_reach.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "rules/box_world.hpp"
#include "rules/explain/explain.hpp"
#include "rules/propose/cluxel_grid.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

TEST(CluxelGrid, FindsAllCluxelsWithinADistance) {
  const Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  const CluxelGrid grid(scene.cluxels);
  for (const double within_m : {0.0, 0.3, 1.0, 4.0})
    for (std::uint32_t cluxel = 0; cluxel < scene.cluxels.size(); cluxel += 37) {
      std::set<std::uint32_t> near, in_plan;
      grid.near(cluxel, within_m, [&](std::uint32_t other) { near.insert(other); });
      grid.nearInPlan(cluxel, within_m, [&](std::uint32_t other) { in_plan.insert(other); });
      for (std::uint32_t other = 0; other < scene.cluxels.size(); ++other) {
        const CluxelGap gap = gapBetween(scene.cluxels, cluxel, other);
        EXPECT_TRUE(gap.gap() > within_m || near.contains(other)) << cluxel << " " << other;
        EXPECT_TRUE(gap.horizontal > within_m || in_plan.contains(other)) << cluxel << " " << other;
      }
    }
}

TEST(RuleReach, CoversWhatATestLooksAt) {
  const Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  const CluxelGrid grid(scene.cluxels);
  const auto reach = [&](const std::string& test) {
    const RuleSet rules = rulesOf("[clx:Bush]", R"(
  - id: bush/any
    class: clx:Bush
    seed: { label: scatter, as: leaves }
    tree:
      test: )" + test + R"(
      yes: { accept: { part: clx:Bush, confidence: 0.9 } }
      no: { reject: other }
)");
    return reachOf(rules.rules.front(), grid);
  };
  EXPECT_EQ(reach("height >= 2 m"), 0.0);
  EXPECT_GE(reach("gap to clx:Bush <= 3 m"), 3.5) << "gaps are told up to half a metre beyond the limit";
  EXPECT_GE(reach("touches clx:Bush"), 1.0);
  EXPECT_EQ(reach("vertical_gap to clx:Bush <= 3 m"), std::nullopt) << "it holds at any distance in plan view";
  const RuleSet shipped = outdoorRules();
  for (const Rule& rule : shipped.rules) {
    const bool finds = std::any_of(rule.nodes.begin(), rule.nodes.end(),
                                   [](const TreeNode& node) { return std::holds_alternative<FindNode>(node.what); });
    EXPECT_TRUE(!finds || !reachOf(rule, grid)) << rule.id << " looks around what it finds";
  }
}

TEST(NearbyChanges, TellsOfEveryChangeWithinReach) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-60, 60), size(0, 9);
  const auto box = [&] {
    const Eigen::Vector2d low(place(random), place(random));
    return Eigen::AlignedBox2d(low, low + Eigen::Vector2d(size(random), size(random)));
  };
  NearbyChanges changes(2.5);
  std::vector<Eigen::AlignedBox2d> made;
  for (int i = 0; i < 40; ++i) changes.add(made.emplace_back(box()));
  std::size_t spared = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::AlignedBox2d asked = box();
    const std::uint32_t known = random() % 41;
    const bool any = std::any_of(made.begin() + known, made.end(),
                                 [&](const auto& change) { return change.exteriorDistance(asked) <= 2.5; });
    EXPECT_TRUE(!any || changes.anyNear(asked, known));
    spared += changes.anyNear(asked, known) ? 0 : 1;
  }
  EXPECT_GT(spared, 20);
}

/// Bushes low enough to be accepted, high ones that need a bush beside them, and a rule that lets bushes grow.
RuleSet rulesOfHighAndLowBushes() {
  return rulesOf("[clx:Bush]", R"(
  - id: bush/any
    class: clx:Bush
    seed: { label: scatter, as: leaves }
    tree:
      test: top <= 1 m
      yes: { accept: { part: clx:Bush, confidence: 0.9 } }
      no:
        test: top <= 3 m
        yes:
          test: gap to clx:Bush <= 1 m
          yes: { accept: { part: clx:Bush, confidence: 0.8 } }
          no: { reject: no bush beside it }
        no:
          test: gap to clx:Bush <= 1 m
          yes: { accept: { part: clx:Bush, merge_into: related, confidence: 0.8 } }
          no: { reject: too high }
)");
}

TEST(RuleReach, ASeedIsRetriedWhateverHappensFarAway) {
  const auto bushesOf = [](bool grows_far_away) {
    BoxScene boxes;
    // The larger seed is decided first, before the bush beside it exists.
    boxes.boxes.push_back(box("high", kScatter, {0, 0, 1}, {2, 2, 2}));
    boxes.boxes.push_back(box("low", kScatter, {1.7, 0, 0.4}, {0.8, 0.8, 0.8}));
    boxes.boxes.push_back(box("far low", kScatter, {90, 0, 0.5}, {3, 3, 0.9}));
    boxes.boxes.push_back(box("far high", kScatter, {grows_far_away ? 92.2 : 99.0, 0, 2}, {0.8, 0.8, 4}));
    const BuiltBoxScene built = sceneOfBoxes(boxes);
    const ReasoningResult result = reason(built.scene, rulesOfHighAndLowBushes());
    std::set<std::string> near;
    for (const SemanticObject& object : result.objects)
      for (const PrimitiveIndex primitive : primitivesOf(object))
        if (!built.names[primitive].starts_with("far")) near.insert(built.names[primitive]);
    return near;
  };
  EXPECT_EQ(bushesOf(true), (std::set<std::string>{"high", "low"}));
  EXPECT_EQ(bushesOf(false), bushesOf(true));
}

}  // namespace
}  // namespace cluxel::testing
