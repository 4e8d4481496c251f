// SPDX-License-Identifier: Apache-2.0
// When a run around a change is refused: by the rules, the window, the traces, or a step that reaches across.
#include <gtest/gtest.h>

#include <algorithm>

#include "perception/segments/scene_part.hpp"
#include "rules/local_run_fixture.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

/// A long wall with a pole at its left end, which goes away, and one at its right end, which belongs to the car behind
/// it. The wall counts when a pole stands at either end.
BoxScene wallBetweenPoles() {
  BoxScene boxes;
  constexpr int kPieces = 16;
  for (int i = 0; i < kPieces; ++i)
    boxes.boxes.push_back(box("wall" + std::to_string(i), kWall, {2.75 * i + 1.25, 0, 1}, {2.5, 0.25, 2}));
  const double end = 2.75 * (kPieces - 1) + 2.5;
  boxes.boxes.push_back(box("left", kColumn, {-0.75, 0, 1}, {0.5, 0.5, 2}));
  boxes.boxes.push_back(box("right", kColumn, {end + 0.75, 0, 1}, {0.5, 0.5, 2}));
  boxes.boxes.push_back(box("car", kSmall, {end + 2.5, 0, 1}, {1, 1, 1}));
  return boxes;
}

TEST(LocalRun, IsRefusedWhenAStepReachesAcrossAllThatAgrees) {
  const RuleSet rules = rulesOf("[clx:Vehicle, clx:Pole, clx:Building]", R"(
  - { id: car, class: clx:Vehicle, seed: { label: small_structure }, tree: { accept: { confidence: 0.9 } } }
  - id: pole
    class: clx:Pole
    seed: { label: column }
    tree:
      test: gap to clx:Vehicle <= 1 m
      yes: { reject: of the car }
      no: { accept: { confidence: 0.9 } }
  - id: wall
    class: clx:Building
    seed: { label: vertical_plane }
    group: { near: 0.5 m }
    tree:
      test: gap to clx:Pole <= 0.5 m
      yes: { accept: { confidence: 0.9 } }
      no: { reject: no pole }
)");
  const double reach_m = localReach(rules).reach_m.value();
  const BuiltBoxScene built = sceneOfBoxes(wallBetweenPoles());
  std::vector<PrimitiveIndex> without_left;
  for (PrimitiveIndex i = 0; i < built.names.size(); ++i)
    if (built.names[i] != "left") without_left.push_back(i);
  const ChangedScene change{built.scene, partOf(built.scene, without_left), {-0.75, 0}};
  const ReasoningResult before = reason(change.before, rules);
  ASSERT_EQ(before.objects.size(), 3U) << "car, left pole, wall";
  ASSERT_EQ(reason(change.after, rules).objects.size(), 1U) << "car";
  // Without the car, the wall has the same gap to a pole as before, but another pole.
  const Window window = windowOf(change, before, 46, reach_m);
  ASSERT_EQ(window.scene.primitives.size(), without_left.size() - 1);
  EXPECT_FALSE(decideLocally(window.input(), rules, {}, reach_m));
  const Window whole = windowOf(change, before, 100, reach_m);
  const auto outcome = decideLocally(whole.input(), rules, {}, reach_m);
  ASSERT_TRUE(outcome);
  EXPECT_EQ(gluedOf(change, before, whole, *outcome, rules).objects.size(), 1U);
}

TEST(LocalRun, IsEmptyWithoutAChange) {
  std::mt19937 random(13);
  const RuleSet rules = smallRules();
  const Scene scene = sceneOfBoxes(randomStreet(random, 40, 0.3)).scene;
  const ReasoningResult before = reason(scene, rules);
  const Window window = windowOf({scene, scene, {20, 0}}, before, 8, 2);
  const auto outcome = decideLocally(window.input(), rules, {}, 2);
  ASSERT_TRUE(outcome);
  EXPECT_TRUE(outcome->result.objects.empty());
  EXPECT_TRUE(std::all_of(outcome->layer.begin(), outcome->layer.end(), [](auto layer) { return layer == kNoLayer; }));
}

TEST(LocalRun, TakesLikelyLayersOnlyForTheFixedPrimitivesThatTheyAreOf) {
  std::mt19937 random(15);
  const RuleSet rules = rulesOfLoneGround();
  const double reach_m = localReach(rules).reach_m.value();
  const ChangedScene change = changeOf(sceneOfBoxes(randomStreet(random, 24, 0.5)).scene, {12, 0}, 4, random);
  const Window window = windowOf(change, reason(change.before, rules), 100, reach_m);
  LocalInput input = window.input();
  const std::vector<std::uint32_t> layers = LocalRun(input, rules, {}, reach_m).layers();
  for (std::size_t i = 0; i < layers.size(); ++i)
    input.likely.is_fixed.push_back(layers[i] == kNoLayer || input.is_dirty[i] != 0 ? 1 : 0);
  input.likely.layers.assign(layers.size(), 7);
  EXPECT_EQ(LocalRun(input, rules, {}, reach_m).layers(), input.likely.layers) << "it is not known of dirty ones";
  const auto clean = std::find(input.is_dirty.begin(), input.is_dirty.end(), 0) - input.is_dirty.begin();
  input.likely.is_fixed[static_cast<std::size_t>(clean)] ^= 1;
  EXPECT_EQ(LocalRun(input, rules, {}, reach_m).layers(), layers);
}

TEST(LocalRun, IsRefusedWhereTheWindowOrTheTracesDoNotShowIt) {
  std::mt19937 random(14);
  const RuleSet rules = smallRules();
  const double reach_m = localReach(rules).reach_m.value();
  const Scene all = sceneOfBoxes(randomStreet(random, 60, 0.2)).scene;
  const ChangedScene change = changeOf(all, {30, 0}, 4, random);
  const ReasoningResult before = reason(change.before, rules);
  Window window = windowOf(change, before, 100, reach_m);
  ASSERT_TRUE(decideLocally(window.input(), rules, {}, reach_m)) << "the window is the whole scene";
  Window closed = window;
  const auto dirty =
      static_cast<std::size_t>(std::find(window.is_dirty.begin(), window.is_dirty.end(), 1) - window.is_dirty.begin());
  closed.is_open[dirty] = 1;
  EXPECT_FALSE(decideLocally(closed.input(), rules, {}, reach_m));
  for (auto& trace : window.stored_trace)
    if (trace) *trace ^= 1U;
  const auto outcome = decideLocally(window.input(), rules, {}, reach_m);
  // All that a chain of hops leads to counts as changed.
  ASSERT_TRUE(outcome);
  EXPECT_TRUE(std::all_of(outcome->layer.begin(), outcome->layer.end(),
                          [](std::uint32_t layer) { return layer == 0 || layer == kNoLayer; }));
}

TEST(LocalReach, FollowsFromTheRulesOrIsRefusedWithTheReason) {
  EXPECT_NEAR(localReach(rulesOfLoneGround()).reach_m.value(), 6.15, 1e-9) << "as far as something may hide an end";
  RuleSet touching_far = rulesOfLoneGround();
  touching_far.contact_m = 5;
  EXPECT_NEAR(localReach(touching_far).reach_m.value(), 10, 1e-9) << "twice as far as volumes of the model touch";
  EXPECT_EQ(strataOfLoneSeeds(rulesOfLoneGround()), 1U);
  EXPECT_EQ(strataOfLoneSeeds(rulesOf("[clx:Pole]", R"(
  - { id: a, class: clx:Pole, seed: { label: column }, tree: { accept: { confidence: 0.5 } } }
)")),
            0U)
      << "an object of its own may grow";
  const auto refused = [](const std::string& body) {
    return localReach(rulesOf("[clx:Building, clx:Pole]", "  - id: a\n    class: clx:Pole\n" + body)).obstacle;
  };
  EXPECT_EQ(refused("    seed: { label: column }\n    tree: { accept: { confidence: 0.5 } }\n"), "");
  EXPECT_EQ(refused(R"(
    seed: { label: column, as: pole }
    tree:
      find: { as: other, label: column, where: [ axis_distance to pole <= 1 m ] }
      found: { accept: { confidence: 0.5 } }
      missing: { reject: alone }
)"),
            "rule 'a' looks things up by a distance without a bound in plan view");
  EXPECT_EQ(refused(R"(
    seed: { label: column, as: pole }
    tree:
      test: vertical_gap to clx:Building <= 1 m
      yes: { accept: { confidence: 0.5 } }
      no: { reject: alone }
)"),
            "rule 'a' measures a distance without a bound in plan view");
  EXPECT_EQ(refused(R"(
    seed: { label: column, as: pole }
    tree: { accept: { merge_into: class, confidence: 0.5,
      absorb: [ { from: { label: scatter }, when: [ gap to pole <= 1 m ], max_fraction_of_points: 1 } ] } }
)"),
            "rule 'a' lets the object of a whole class grow");
  EXPECT_EQ(refused(R"(
    seed: { label: column, as: pole }
    tree:
      test: gap to clx:Building >= 3 m
      yes: { accept: { merge_into: related, confidence: 0.5 } }
      no: { reject: beside a building }
)"),
            "rule 'a' joins an object that may be far away");
}

}  // namespace
}  // namespace cluxel::testing
