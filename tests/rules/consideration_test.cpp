// SPDX-License-Identifier: Apache-2.0
// What a class says of a thing in a window is what it says of it in the whole scene.
#include "rules/propose/consideration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "rules/explain/explain.hpp"
#include "rules/local_run_fixture.hpp"

namespace cluxel::testing {

using namespace perception;
using namespace rules;
namespace {

/// Without numbers of primitives, which differ in a window.
std::string saidBy(const std::vector<Consideration>& said) {
  std::string words;
  for (const Consideration& one : said) {
    const Decision& decision = one.decision;
    words += decision.rule_id + (one.is_seed ? " seed" : "") + (one.has_label ? " label" : "") +
             (decision.accepted ? " accepted" : "") + " " + std::to_string(decision.leaf) + " " + decision.reason +
             " " + std::to_string(decision.log_odds) + " " + std::to_string(decision.seeds.size()) + "\n";
    for (const DecisionStep& step : decision.path)
      words +=
          "  " + step.test + " " + std::to_string(step.measured.value_or(-1)) + (step.passed ? " yes" : " no") + "\n";
    for (const DecisionFlip& flip : decision.flips)
      words += "  flip " + flip.changes.at(0).test + " " + std::to_string(flip.changes.size()) +
               (flip.accepted ? " accepted " : " ") + flip.outcome + "\n";
  }
  return words;
}

int streetsOf(int few, int many) {
  return std::getenv("CLUXEL_LONG_TESTS") != nullptr ? many : few;
}

struct Answers {
  std::size_t cases = 0, in_window = 0, seeds = 0;
};

/// Asks about random things of a street, each for a random class.
void askInStreet(const RuleSet& rules, double length_m, double things_per_m, std::mt19937& random, Answers& outcomes) {
  const LocalReach reach = localReach(rules);
  ASSERT_TRUE(reach.reach_m) << reach.obstacle;
  const Scene all = sceneOfBoxes(randomStreet(random, length_m, things_per_m)).scene;
  const ReasoningResult whole = reason(all, rules);
  std::vector<std::string> classes;
  for (const auto& stratum : rules.strata) classes.insert(classes.end(), stratum.begin(), stratum.end());
  for (int question = 0; question < 12; ++question) {
    std::vector<PrimitiveIndex> thing{static_cast<PrimitiveIndex>(random() % all.primitives.size())};
    for (const SemanticObject& object : whole.objects)
      if (const auto own = primitivesOf(object);
          !object.is_class_wide && random() % 2 == 0 && std::binary_search(own.begin(), own.end(), thing.front()))
        thing = own;
    const std::string& asked = classes[random() % classes.size()];
    const std::string expected = saidBy(considerFor(all, rules, {}, asked, thing));
    ++outcomes.cases;
    const Primitive& first = all.primitives[thing.front()];
    const Eigen::Vector2d place = (first.min + first.max).head<2>() / 2;
    for (const double around_m : {8.0, 16.0, 32.0, 48.0}) {
      Window window = windowOf({all, all, place}, whole, around_m, *reach.reach_m);
      std::size_t held = 0;
      for (PrimitiveIndex i = 0; i < window.scene.primitives.size(); ++i)
        for (const PrimitiveIndex part : thing)
          if (window.scene.primitives[i].id == all.primitives[part].id) window.is_dirty[i] = 1, ++held;
      if (held < thing.size()) continue;
      const auto said = considerIn(window.input(), rules, {}, asked, *reach.reach_m);
      if (!said) continue;
      ++outcomes.in_window;
      outcomes.seeds += said->empty() || !said->front().is_seed ? 0 : 1;
      ASSERT_EQ(saidBy(*said), expected) << asked << ", question " << question << ", within " << around_m;
    }
  }
}

void askInStreets(const RuleSet& rules, int streets, std::mt19937& random) {
  Answers outcomes;
  for (int street = 0; street < streets; ++street) {
    askInStreet(rules, within(random, 80, 160), within(random, 0.1, 0.6), random, outcomes);
    if (::testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(outcomes.in_window, outcomes.cases) << "most are answered in more than one window";
  EXPECT_GT(10 * outcomes.seeds, outcomes.in_window) << "of a tenth of the answers the first rule looked at the thing";
}

TEST(Consideration, InAWindowIsThatOfTheWholeWithSmallRules) {
  std::mt19937 random(21);
  askInStreets(smallRules(), streetsOf(4, 60), random);
}

TEST(Consideration, InAWindowIsThatOfTheWholeWithTheShippedRules) {
  std::mt19937 random(22);
  askInStreets(rulesOfLoneGround(), streetsOf(3, 40), random);
}

/// A find among objects comes to the ground, which reaches far, and looks on from there.
TEST(Consideration, InAWindowIsNotToldOfARuleThatLooksAlongObjects) {
  const RuleSet rules = rulesOf("[clx:Ground, clx:SmallObject]", R"(
  - id: ground
    class: clx:Ground
    seed: { label: horizontal_plane }
    tree: { accept: { merge_into: class, confidence: 0.9 } }
  - id: thing/with-column
    class: clx:SmallObject
    seed: { label: small_structure, as: thing }
    tree:
      find: { as: floor, object: clx:Ground, where: [ gap to thing <= 2 m ], choose: nearest }
      missing: { reject: no floor }
      found:
        find: { as: other, label: column, where: [ gap to floor <= 0.5 m ], choose: nearest }
        found: { accept: { confidence: 0.6 } }
        missing: { reject: no column }
)");
  BoxScene boxes;
  boxes.boxes.push_back(box("floor", kGroundLabel, {50, 0, 0}, {100, 4, 0.1}));
  boxes.boxes.push_back(box("thing", kSmall, {2, 0, 0.6}, {0.5, 0.5, 1}));
  boxes.boxes.push_back(box("column", kColumn, {98, 0, 1.1}, {0.2, 0.2, 2}));
  const Scene all = sceneOfBoxes(boxes).scene;
  const double reach_m = localReach(rules).reach_m.value_or(6);
  const ReasoningResult whole = reason(all, rules);
  Window window = windowOf({all, all, {2, 0}}, whole, 20, reach_m);
  for (PrimitiveIndex i = 0; i < window.scene.primitives.size(); ++i)
    window.is_dirty[i] = window.scene.primitives[i].label == kSmall ? 1 : 0;
  ASSERT_EQ(std::count(window.is_dirty.begin(), window.is_dirty.end(), 1), 1);
  EXPECT_FALSE(considerIn(window.input(), rules, {}, rules.rules.back().class_iri, reach_m));
}

}  // namespace
}  // namespace cluxel::testing
