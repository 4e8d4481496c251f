// SPDX-License-Identifier: Apache-2.0
// `merge_into: class` makes one object of a class, however far apart its pieces are.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "rules/box_world.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

RuleSet rulesOfOneGround() {
  return rulesOf("[clx:Ground]", R"(
  - id: ground/one
    class: clx:Ground
    seed: { label: horizontal_plane }
    group: { near: 1 m }
    tree:
      test: footprint_area >= 4 m2
      yes: { accept: { merge_into: class, confidence: 0.9 } }
      no:
        test: footprint_area >= 1 m2
        yes: { accept: { merge_into: class, confidence: 0.6 } }
        no: { reject: too small }
)");
}

BoxScene patchesFarApart() {
  BoxScene boxes;
  boxes.boxes.push_back(box("field", PrimitiveLabel::HorizontalPlane, {0, 0, 0}, {6, 6, 0.05}));
  boxes.boxes.push_back(box("yard", PrimitiveLabel::HorizontalPlane, {40, 0, 0}, {3, 3, 0.05}));
  boxes.boxes.push_back(box("step", PrimitiveLabel::HorizontalPlane, {80, 0, 0}, {1.4, 1.4, 0.05}));
  boxes.boxes.push_back(box("tray", PrimitiveLabel::HorizontalPlane, {90, 0, 0}, {0.4, 0.4, 0.05}));
  return boxes;
}

TEST(MergeIntoClass, MakesOneObjectOfAllThatAreAccepted) {
  const BuiltBoxScene built = sceneOfBoxes(patchesFarApart());
  const ReasoningResult result = reason(built.scene, rulesOfOneGround());
  EXPECT_THAT(inWords(built, result), ::testing::ElementsAre("Ground{Ground: field step yard}"));
  ASSERT_EQ(result.objects.size(), 1u);
  EXPECT_EQ(result.objects.front().confidence, 0.9) << "that of the largest patch, which is decided first";
}

TEST(MergeIntoClass, DoesNotDependOnTheOrderOfBoxes) {
  BoxScene boxes = patchesFarApart();
  const ContentHash expected = reason(sceneOfBoxes(boxes).scene, rulesOfOneGround()).objects.front().id;
  std::mt19937 random(3);
  for (int round = 0; round < 6; ++round) {
    std::shuffle(boxes.boxes.begin(), boxes.boxes.end(), random);
    const ReasoningResult result = reason(sceneOfBoxes(boxes).scene, rulesOfOneGround());
    ASSERT_EQ(result.objects.size(), 1u);
    EXPECT_EQ(result.objects.front().id, expected);
  }
}

TEST(MergeIntoClass, KeepsADecisionForEveryPatch) {
  const BuiltBoxScene built = sceneOfBoxes(patchesFarApart());
  const ReasoningResult result = reason(built.scene, rulesOfOneGround());
  EXPECT_EQ(std::count_if(result.decisions.begin(), result.decisions.end(), [](const auto& d) { return d.accepted; }),
            3);
}

}  // namespace
}  // namespace cluxel::testing
