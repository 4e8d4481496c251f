// SPDX-License-Identifier: Apache-2.0
// A run around a change, glued with the run before, is the run over the whole new scene.
#include <gtest/gtest.h>

#include <algorithm>

#include "perception/segments/scene_part.hpp"
#include "rules/local_run_fixture.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

/// A thing is taken when no other was taken beside it: in a row of ever smaller things each decision turns the next
/// one.
RuleSet dominoRules() {
  return rulesOf("[clx:SmallObject]", R"(
  - id: domino
    class: clx:SmallObject
    seed: { label: small_structure, as: thing }
    tree:
      test: gap to clx:SmallObject <= 1.2 m
      yes: { reject: beside another one }
      no: { accept: { confidence: 0.9 } }
)");
}

BoxScene rowsOfDominoes(std::mt19937& random, double length_m) {
  BoxScene row;
  double height = 0;
  for (double x = 0; x < length_m; x += within(random, 1.2, 1.5)) {
    height = height < 0.5 ? 0.25 * static_cast<double>(4 + random() % 18) : height - 0.25;
    row.boxes.push_back(
        box("domino" + std::to_string(row.boxes.size()), kSmall, {x, 0, height / 2 + 0.1}, {0.5, 0.5, height}));
  }
  return row;
}

struct Outcomes {
  std::size_t cases = 0, local = 0, changed = 0;
  std::ptrdiff_t went_on = 0;  ///< most primitives that a change turned, though they are as before
};

std::ptrdiff_t turnedBy(const Window& window, const LocalOutcome& outcome) {
  std::ptrdiff_t turned = 0;
  for (PrimitiveIndex i = 0; i < outcome.layer.size(); ++i)
    turned += window.is_dirty[i] == 0 && outcome.layer[i] == 0 && window.stored_trace[i] != outcome.result.traces[i];
  return turned;
}

/// Tries windows of growing size around random changes of a street, and compares with the whole run.
void checkStreet(const RuleSet& rules, const BoxScene& street, double length_m, int changes, std::mt19937& random,
                 Outcomes& outcomes) {
  const LocalReach reach = localReach(rules);
  ASSERT_TRUE(reach.reach_m) << reach.obstacle;
  const Scene all = sceneOfBoxes(street).scene;
  for (int change_number = 0; change_number < changes; ++change_number) {
    const ChangedScene change =
        changeOf(all, {within(random, 0.2, 0.8) * length_m, within(random, -2, 2)}, within(random, 0.5, 3), random);
    const ReasoningResult before = reason(change.before, rules), whole = reason(change.after, rules);
    ++outcomes.cases;
    for (const double around_m : {0.15 * length_m, 0.25 * length_m, 0.35 * length_m}) {
      const Window window = windowOf(change, before, around_m, *reach.reach_m);
      const auto outcome = decideLocally(window.input(), rules, {}, *reach.reach_m);
      if (!outcome) continue;
      ++outcomes.local;
      outcomes.went_on = std::max(outcomes.went_on, turnedBy(window, *outcome));
      const KnownObjects expected = objectsIn(change.after, whole, rules);
      outcomes.changed += expected != objectsIn(change.before, before, rules) ? 1 : 0;
      const Glued glued = gluedOf(change, before, window, *outcome, rules);
      ASSERT_EQ(glued.objects, expected) << "change " << change_number << ", window " << around_m;
      ASSERT_EQ(glued.traces, tracesOf(change.after, whole.traces));
      break;
    }
  }
}

/// A street takes more rounds of rivals when it is denser; every case in which a seam is found is compared.
Outcomes checkStreets(const RuleSet& rules, int streets, std::pair<double, double> lengths_m,
                      std::pair<double, double> things_per_m, std::mt19937& random) {
  Outcomes outcomes;
  for (int street = 0; street < streets; ++street) {
    const double length_m = within(random, lengths_m.first, lengths_m.second);
    const BoxScene boxes = randomStreet(random, length_m, within(random, things_per_m.first, things_per_m.second));
    checkStreet(rules, boxes, length_m, 4, random, outcomes);
    if (::testing::Test::HasFatalFailure()) return outcomes;
  }
  EXPECT_GE(4 * outcomes.local, 3 * outcomes.cases) << "most changes are decided around them";
  EXPECT_GE(3 * outcomes.changed, outcomes.cases) << "most changes change objects";
  return outcomes;
}

TEST(LocalRun, GivesTheWholeRunWithSmallRules) {
  std::mt19937 random(11);
  EXPECT_GE(checkStreets(smallRules(), 12, {60, 120}, {0.15, 0.6}, random).went_on, 1);
}

TEST(LocalRun, GivesTheWholeRunWhereChangesGoFar) {
  std::mt19937 random(15);
  Outcomes outcomes;
  for (int row = 0; row < 25; ++row) {
    checkStreet(dominoRules(), rowsOfDominoes(random, 160), 160, 8, random, outcomes);
    if (HasFatalFailure()) return;
  }
  EXPECT_GE(2 * outcomes.local, outcomes.cases);
  EXPECT_GE(outcomes.went_on, 4) << "along the row";
}

TEST(LocalRun, GivesTheWholeRunWithTheShippedRules) {
  std::mt19937 random(12);
  checkStreets(rulesOfLoneGround(), 6, {200, 300}, {0.08, 0.2}, random);
}

TEST(Traces, DependNeitherOnThreadsNorOnWhatIsFarAwayNorOnNumbers) {
  std::mt19937 random(5);
  for (const RuleSet& rules : {smallRules(), rulesOfLoneGround()}) {
    BoxScene boxes = randomStreet(random, 60, 0.4);
    const std::size_t near = boxes.boxes.size();
    for (BoxPrimitive made : randomStreet(random, 60, 0.7).boxes) {
      made.center.x() += 200;
      boxes.boxes.push_back(made);
    }
    // The grids of a scene are as coarse as its largest cluxel.
    boxes.boxes.push_back(box("sea", kScatter, {400, 0, -2}, {100, 100, 1}));
    const BuiltBoxScene built = sceneOfBoxes(boxes);
    std::vector<PrimitiveIndex> kept;
    for (PrimitiveIndex i = 0; i < built.scene.primitives.size(); ++i)
      if (built.scene.primitives[i].centroid.x() < 100) kept.push_back(i);
    ASSERT_EQ(kept.size(), near);
    const ReasoningResult both = reason(built.scene, rules);
    EXPECT_EQ(both.traces, reason(built.scene, rules, {.threads = 3}).traces);
    const Scene part = partOf(built.scene, kept);
    const ReasoningResult alone = reason(part, rules);
    for (PrimitiveIndex i = 0; i < kept.size(); ++i)
      EXPECT_EQ(alone.traces[i], both.traces[kept[i]]) << built.names[kept[i]];
  }
}

}  // namespace
}  // namespace cluxel::testing
